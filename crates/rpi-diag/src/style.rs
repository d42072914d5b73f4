//! How a terminal wants its findings.

use std::io::IsTerminal;

/// What the reader's terminal can show.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Style {
    /// Colours by ANSI escapes.
    pub color: bool,
    /// Line drawing with Unicode characters; ASCII otherwise.
    pub unicode: bool,
    /// Columns at which prose is wrapped.
    pub width: usize,
}

impl Style {
    /// No escapes at all, 100 columns: for files, pipes and tests.
    pub const PLAIN: Style = Style {
        color: false,
        unicode: true,
        width: 100,
    };

    /// What suits a stream: colours only on a terminal that did not ask to go without (`NO_COLOR`,
    /// see <https://no-color.org>, or `TERM=dumb`).
    pub fn of(stream: &impl IsTerminal) -> Style {
        let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
            || std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        Style {
            color: stream.is_terminal() && !refused,
            ..Style::PLAIN
        }
    }
}

impl Default for Style {
    fn default() -> Style {
        Style::PLAIN
    }
}
