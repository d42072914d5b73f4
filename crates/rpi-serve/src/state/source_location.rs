//! Location in a program, for reports about its commands.

use rpi_diag::{SourceMap, Span};
use rpi_image::image;

/// Location in the program of a command, as reported to clients.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct SourceLocation {
    /// Path of the node or fragment in the program.
    pub(crate) path: String,
    /// Position as `line:column` in the client's text; `None` if the location is in a library or unknown.
    pub(crate) position: Option<String>,
}

impl SourceLocation {
    /// Converts the location of a node in an image. `text` is the source text of the command, to convert the offset to
    /// a line and column.
    pub(super) fn from_node(place: &image::SourceLocation, text: Option<&str>) -> SourceLocation {
        let own = place.range.filter(|range| range.file == 0);
        let at = own.zip(text).map(|(range, text)| {
            let mut sources = SourceMap::new();
            let file = sources.add("", text);
            let (start, end) = (range.start, range.end);
            sources.line_col(Span { file, start, end }).to_string()
        });
        SourceLocation {
            path: place.path.clone(),
            position: at,
        }
    }

    /// Creates the location of a fragment from its path in the net, without a position in the text.
    pub(super) fn from_fragment(path: &str) -> SourceLocation {
        SourceLocation {
            path: path.to_owned(),
            position: None,
        }
    }
}
