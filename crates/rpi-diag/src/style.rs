//! How a terminal wants its findings.

use std::io::IsTerminal;

use terminal_size::{Width, terminal_size};

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
    /// see <https://no-color.org>, or `TERM=dumb`); no wider than the terminal.
    pub fn of(stream: &impl IsTerminal) -> Style {
        let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
            || std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        let terminal = stream.is_terminal();
        let size = terminal_size().filter(|_| terminal);
        Style {
            color: terminal && !refused,
            width: size.map_or(Style::PLAIN.width, |(Width(columns), _)| {
                readable(columns.into())
            }),
            ..Style::PLAIN
        }
    }
}

/// Prose in a terminal of so many columns: neither squeezed nor in lines that the eye loses.
fn readable(columns: usize) -> usize {
    columns.clamp(40, Style::PLAIN.width)
}

impl Default for Style {
    fn default() -> Style {
        Style::PLAIN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prose_is_as_wide_as_the_terminal_within_bounds() {
        assert_eq!([10, 72, 300].map(readable), [40, 72, 100]);
    }
}
