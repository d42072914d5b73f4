//! Where in a program something has happened to its command.

use rpi_diag::{SourceMap, Span};
use rpi_image::image;

/// A place in a program.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Place {
    /// The path to the node or fragment.
    pub(crate) path: String,
    /// `line:column` in the text that the client gave, if it stands there and not in a library.
    pub(crate) at: Option<String>,
}

impl Place {
    /// That of a node, in a command that was made of `text`.
    pub(super) fn of_node(place: &image::Place, text: Option<&str>) -> Place {
        let own = place.text.filter(|range| range.file == 0);
        let at = own.zip(text).map(|(range, text)| {
            let mut sources = SourceMap::new();
            let file = sources.add("", text);
            let (start, end) = (range.start, range.end);
            sources.line_col(Span { file, start, end }).to_string()
        });
        Place {
            path: place.path.clone(),
            at,
        }
    }

    /// That of a fragment.
    pub(super) fn of_fragment(path: &str) -> Place {
        Place {
            path: path.to_owned(),
            at: None,
        }
    }
}
