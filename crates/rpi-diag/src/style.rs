//! Terminal capabilities that influence the output.

use std::io::IsTerminal;

use terminal_size::{Width, terminal_size};

/// Capabilities of the output terminal.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Style {
    /// Whether to use colours (ANSI escape sequences).
    pub color: bool,
    /// Whether to draw lines with Unicode characters; ASCII otherwise.
    pub unicode: bool,
    /// Column at which text is wrapped.
    pub width: usize,
}

impl Style {
    /// Style without escape sequences, 100 columns wide: for files, pipes and tests.
    pub const PLAIN: Style = Style {
        color: false,
        unicode: true,
        width: 100,
    };

    /// Detects the style of a stream. Colours are used on a terminal only, unless `NO_COLOR` (see
    /// <https://no-color.org>) or `TERM=dumb` is set. The width is at most that of the terminal.
    pub fn for_stream(stream: &impl IsTerminal) -> Style {
        let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
            || std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        let terminal = stream.is_terminal();
        let size = terminal_size().filter(|_| terminal);
        Style {
            color: terminal && !refused,
            width: size.map_or(Style::PLAIN.width, |(Width(columns), _)| {
                clamp_width(columns.into())
            }),
            ..Style::PLAIN
        }
    }
}

/// Clamps the width of a terminal to a readable text width: 40 to 100 columns.
fn clamp_width(columns: usize) -> usize {
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
        assert_eq!([10, 72, 300].map(clamp_width), [40, 72, 100]);
    }
}
