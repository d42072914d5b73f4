//! Terminal capabilities that influence the output.

use std::io::IsTerminal;

use terminal_size::{Width, terminal_size};

/// Capabilities of the terminal or file to which diagnostics are printed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Style {
    /// True if the output may contain colours (ANSI escape sequences).
    pub color: bool,
    /// True if lines are drawn with Unicode characters, false for ASCII.
    pub unicode: bool,
    /// Number of characters per line, at which help texts and notes are wrapped.
    pub width: usize,
}

impl Style {
    /// Style for files, pipes and tests: no colours, Unicode lines, 100 characters per line.
    pub const PLAIN: Style = Style {
        color: false,
        unicode: true,
        width: 100,
    };

    /// Returns the style for a stream. Colours are used only on a terminal, and not if `NO_COLOR` (see
    /// <https://no-color.org>) or `TERM=dumb` is set. The width is that of the terminal, from 40 to 100 characters.
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

/// Returns a readable text width for a terminal of `columns` columns: 40 to 100.
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
