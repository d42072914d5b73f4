//! Report of a run: the page with the document in it, as one HTML file.

use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;

use crate::PAGE;
use crate::document::{Precision, ViewContent, document};

/// Mark in the page in place of the document.
const MARK: &str = "<!--document-->";

/// Returns the report of a run as the text of one HTML file, which needs no other file and no network. Real values are
/// rounded to 2⁻³¹ of the largest magnitude of their flow.
///
/// # Errors
/// Returns an error if the compressor fails, for lack of memory.
pub fn report(content: ViewContent<'_>) -> io::Result<String> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(&document(content, Precision::Rounded))?;
    let text = STANDARD.encode(encoder.finish()?);
    let (before, after) = PAGE.split_once(MARK).unwrap_or((PAGE, ""));
    Ok(format!(
        "{before}<script type=\"text/plain\" id=\"document\">{text}</script>{after}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_one_place_for_the_document() {
        assert_eq!(PAGE.matches(MARK).count(), 1);
    }
}
