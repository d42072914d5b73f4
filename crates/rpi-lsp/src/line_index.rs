//! Conversion between byte offsets and the positions of the protocol (line, and column in code units of an encoding).

use lsp_types::{Position, PositionEncodingKind};

/// Unit in which the client counts columns of a line (position encoding of the protocol).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Encoding {
    /// Columns count bytes of the UTF-8 text.
    Utf8,
    /// Columns count 16-bit code units of UTF-16. This is the default of the protocol, which every client supports.
    Utf16,
}

impl Encoding {
    /// Returns UTF-8 if the client supports it, else UTF-16. `known` lists the encodings that the client supports.
    pub(crate) fn negotiate(known: Option<&[PositionEncodingKind]>) -> Encoding {
        match known.is_some_and(|known| known.contains(&PositionEncodingKind::UTF8)) {
            true => Encoding::Utf8,
            false => Encoding::Utf16,
        }
    }

    pub(crate) fn kind(self) -> PositionEncodingKind {
        match self {
            Encoding::Utf8 => PositionEncodingKind::UTF8,
            Encoding::Utf16 => PositionEncodingKind::UTF16,
        }
    }

    fn width(self, c: char) -> usize {
        match self {
            Encoding::Utf8 => c.len_utf8(),
            Encoding::Utf16 => c.len_utf16(),
        }
    }
}

/// Table of the byte offsets at which the lines of a text start.
#[derive(Clone, Debug)]
pub(crate) struct LineIndex {
    starts: Vec<usize>,
}

impl LineIndex {
    /// Creates the table for a text. A line ends with `\n`, `\r\n` or `\r`, as the protocol specifies.
    pub(crate) fn new(text: &str) -> LineIndex {
        let bytes = text.as_bytes();
        let ends = |at: &usize| match bytes[*at] {
            b'\n' => true,
            b'\r' => bytes.get(at + 1) != Some(&b'\n'),
            _ => false,
        };
        let after = (0..bytes.len()).filter(ends).map(|at| at + 1);
        LineIndex {
            starts: std::iter::once(0).chain(after).collect(),
        }
    }

    /// Converts a byte offset in `text` to a line and a column, both from 0. An offset inside a character counts as the
    /// start of the character.
    pub(crate) fn position(&self, text: &str, offset: usize, encoding: Encoding) -> Position {
        let offset = text.floor_char_boundary(offset);
        // The first start is 0, so the subtraction cannot underflow.
        let line = self.starts.partition_point(|start| *start <= offset) - 1;
        let before = text[self.starts[line]..offset].chars();
        Position {
            line: saturating_u32(line),
            character: saturating_u32(before.map(|c| encoding.width(c)).sum()),
        }
    }

    /// Converts a line and a column to a byte offset in `text`. A column beyond the end of the line counts as the end
    /// of the line, and a line beyond the text as the end of the text.
    pub(crate) fn offset(&self, text: &str, position: Position, encoding: Encoding) -> usize {
        let Some(start) = self.starts.get(position.line as usize) else {
            return text.len();
        };
        let next = self.starts.get(position.line as usize + 1);
        let line = text[*start..next.copied().unwrap_or(text.len())].trim_end_matches(['\r', '\n']);
        let mut left = position.character as usize;
        for (at, c) in line.char_indices() {
            let width = encoding.width(c);
            if left < width {
                return start + at;
            }
            left -= width;
        }
        start + line.len()
    }
}

fn saturating_u32(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TEXT: &str = "a\u{e4}\u{1f916}b\r\nc\rd\n";

    #[test]
    fn columns_count_units_of_the_encoding() {
        let lines = LineIndex::new(TEXT);
        let b = TEXT.find('b').unwrap();
        assert_eq!(
            lines.position(TEXT, b, Encoding::Utf16),
            Position::new(0, 4)
        );
        assert_eq!(lines.position(TEXT, b, Encoding::Utf8), Position::new(0, 7));
        assert_eq!(lines.offset(TEXT, Position::new(0, 4), Encoding::Utf16), b);
        // Between the two UTF-16 units of the robot character, and between its bytes.
        assert_eq!(lines.offset(TEXT, Position::new(0, 3), Encoding::Utf16), 3);
        assert_eq!(
            lines.position(TEXT, 5, Encoding::Utf16),
            Position::new(0, 2)
        );
    }

    #[test]
    fn all_three_line_ends_count_and_places_beyond_are_clamped() {
        let lines = LineIndex::new(TEXT);
        let at =
            |line, character| lines.offset(TEXT, Position::new(line, character), Encoding::Utf16);
        assert_eq!(&TEXT[at(1, 0)..at(1, 99)], "c");
        assert_eq!(&TEXT[at(2, 0)..at(2, 99)], "d");
        assert_eq!((at(3, 0), at(99, 0)), (TEXT.len(), TEXT.len()));
    }

    proptest! {
        #[test]
        fn positions_lead_back_to_where_they_are_from(text in "[a\u{e4}\u{1f916}\r\n ]{0,40}") {
            let lines = LineIndex::new(&text);
            for encoding in [Encoding::Utf8, Encoding::Utf16] {
                for (offset, _) in text.char_indices() {
                    let inside_line_end = text[..offset].ends_with('\r') && text[offset..].starts_with('\n');
                    let position = lines.position(&text, offset, encoding);
                    let back = lines.offset(&text, position, encoding);
                    prop_assert!(back == offset || inside_line_end, "{offset} {back}");
                }
            }
        }
    }
}
