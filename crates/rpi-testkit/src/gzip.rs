//! Reading of recorded data, compressed or not.

use std::io::{self, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;

/// Returns the text of a file, decompressed if it begins with the magic number of gzip (RFC 1952, section 2.3.1).
///
/// # Errors
///
/// Returns an error if the file cannot be read, is invalid gzip, is too large, or is not UTF-8.
pub fn read_maybe_gz(path: impl AsRef<Path>) -> io::Result<String> {
    let bytes = rpi_files::read(path.as_ref(), rpi_files::MAX_TRACE)?;
    String::from_utf8(bytes).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
}

/// Returns a gzip file with this content.
///
/// # Panics
/// Never: writing to memory does not fail.
#[must_use]
pub fn gzip(content: &[u8]) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    let written = packed.write_all(content).and_then(|()| packed.finish());
    written.expect("memory can be written")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_and_packed_text_read_the_same() {
        let dir = std::env::temp_dir().join(format!("rpi-testkit-gz-{}", std::process::id()));
        std::fs::create_dir_all(&dir).unwrap();
        std::fs::write(dir.join("a.gz"), gzip(b"cycle;1\n")).unwrap();
        std::fs::write(dir.join("a"), "cycle;1\n").unwrap();
        assert_eq!(read_maybe_gz(dir.join("a.gz")).unwrap(), "cycle;1\n");
        assert_eq!(read_maybe_gz(dir.join("a")).unwrap(), "cycle;1\n");
        assert!(read_maybe_gz(dir.join("b")).is_err());
        std::fs::remove_dir_all(dir).unwrap();
    }
}
