//! Places in source texts: files, byte ranges, lines and columns.

use std::fmt;

/// A source text in a [`SourceMap`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub struct FileId(pub u32);

/// A range of bytes `start..end` in one file.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub struct Span {
    /// The text that the range lies in.
    pub file: FileId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The place of what has no text: a net that a program made, a built-in declaration.
    pub const NONE: Span = Span {
        file: FileId(u32::MAX),
        start: 0,
        end: 0,
    };

    /// The range `start..end` of `file`, in bytes.
    pub const fn new(file: FileId, start: u32, end: u32) -> Span {
        Span { file, start, end }
    }

    /// The smallest range over both. [`Span::NONE`] is the neutral element; of two files the first
    /// range is kept, as no range spans files.
    #[must_use]
    pub fn merge(self, other: Span) -> Span {
        match (self.is_none(), other.is_none()) {
            (true, _) => other,
            (_, true) => self,
            _ if self.file != other.file => self,
            _ => Span::new(
                self.file,
                self.start.min(other.start),
                self.end.max(other.end),
            ),
        }
    }

    /// Whether another place lies in this one.
    #[must_use]
    pub fn contains(self, other: Span) -> bool {
        self.file == other.file && self.start <= other.start && other.end <= self.end
    }

    /// Whether no byte lies in the range.
    pub fn is_empty(self) -> bool {
        self.start >= self.end
    }

    /// Whether this place has no text.
    pub fn is_none(self) -> bool {
        self.file == Span::NONE.file
    }
}

/// A line and a column, both counted from 1; the column counts Unicode scalar values.
#[derive(Clone, Copy, PartialEq, Eq, Debug, PartialOrd, Ord)]
pub struct LineCol {
    /// Line, from 1.
    pub line: u32,
    /// Column, from 1.
    pub col: u32,
}

impl fmt::Display for LineCol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.col)
    }
}

/// The source texts of one run, by name.
#[derive(Clone, Debug, Default)]
pub struct SourceMap {
    files: Vec<SourceFile>,
}

#[derive(Clone, Debug)]
struct SourceFile {
    name: String,
    text: String,
    /// Byte offsets at which lines start; the first is 0.
    line_starts: Vec<usize>,
}

impl SourceMap {
    /// An empty map.
    pub fn new() -> SourceMap {
        SourceMap::default()
    }

    /// Takes up a text under the name that messages shall show.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<String>) -> FileId {
        let text = text.into();
        let line_starts = line_starts(&text);
        self.files.push(SourceFile {
            name: name.into(),
            text,
            line_starts,
        });
        FileId(u32::try_from(self.files.len() - 1).unwrap_or(u32::MAX))
    }

    /// Takes up all files of another map; a file of the same name and text is the same file. For each file of the other
    /// map, in its order, the file here.
    pub fn absorb(&mut self, other: &SourceMap) -> Vec<FileId> {
        let mut taken = Vec::with_capacity(other.files.len());
        for file in &other.files {
            let same = |id: &FileId| self.name(*id) == file.name && self.text(*id) == file.text;
            let known = self.files().find(same);
            taken.push(known.unwrap_or_else(|| self.add(file.name.clone(), file.text.clone())));
        }
        taken
    }

    /// The name of a file; empty for one that is not in the map.
    pub fn name(&self, id: FileId) -> &str {
        self.file(id).map_or("", |f| &f.name)
    }

    /// The text of a file; empty for one that is not in the map.
    pub fn text(&self, id: FileId) -> &str {
        self.file(id).map_or("", |f| &f.text)
    }

    /// All files, in the order in which they were added.
    pub fn files(&self) -> impl Iterator<Item = FileId> + '_ {
        (0..self.files.len()).map(|i| FileId(i as u32))
    }

    /// The text of a range, clamped to the file and to whole characters.
    pub fn slice(&self, span: Span) -> &str {
        let (start, end) = self.clamp(span);
        &self.text(span.file)[start..end]
    }

    /// Where a range starts. `1:1` for a file that is not in the map.
    pub fn line_col(&self, span: Span) -> LineCol {
        self.line_col_at(span.file, self.clamp(span).0)
    }

    /// Where a range ends: the place just after its last character.
    pub fn line_col_end(&self, span: Span) -> LineCol {
        self.line_col_at(span.file, self.clamp(span).1)
    }

    /// The range as byte offsets that lie in the text and on character boundaries.
    pub(crate) fn clamp(&self, span: Span) -> (usize, usize) {
        let text = self.text(span.file);
        let start = floor_char(text, span.start as usize);
        let end = floor_char(text, span.end as usize).max(start);
        (start, end)
    }

    fn line_col_at(&self, file: FileId, offset: usize) -> LineCol {
        let Some(file) = self.file(file) else {
            return LineCol { line: 1, col: 1 };
        };
        let line = file.line_starts.partition_point(|&start| start <= offset) - 1;
        let before = &file.text[file.line_starts[line]..offset];
        LineCol {
            line: line as u32 + 1,
            col: before.chars().count() as u32 + 1,
        }
    }

    fn file(&self, id: FileId) -> Option<&SourceFile> {
        self.files.get(id.0 as usize)
    }
}

fn line_starts(text: &str) -> Vec<usize> {
    std::iter::once(0)
        .chain(text.match_indices('\n').map(|(at, _)| at + 1))
        .collect()
}

/// The largest character boundary of `text` that is at most `offset`.
fn floor_char(text: &str, offset: usize) -> usize {
    let offset = offset.min(text.len());
    (0..=offset)
        .rev()
        .find(|&at| text.is_char_boundary(at))
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(text: &str) -> (SourceMap, FileId) {
        let mut sources = SourceMap::new();
        let file = sources.add("a.rpi", text);
        (sources, file)
    }

    #[test]
    fn columns_count_characters_not_bytes() {
        let (sources, file) = one("x\nä = 1\n");
        let span = Span::new(file, 5, 6);
        assert_eq!(sources.line_col(span), LineCol { line: 2, col: 3 });
        assert_eq!(sources.line_col_end(span).to_string(), "2:4");
    }

    #[test]
    fn ranges_outside_the_text_are_clamped() {
        let (sources, file) = one("ä");
        assert_eq!(sources.slice(Span::new(file, 1, 99)), "ä");
        assert_eq!(sources.line_col(Span::new(file, 99, 99)).to_string(), "1:2");
        assert_eq!(sources.slice(Span::NONE), "");
        assert_eq!(sources.line_col(Span::NONE).to_string(), "1:1");
    }

    #[test]
    fn merging_covers_both_and_ignores_what_has_no_text() {
        let file = FileId(0);
        let (a, b) = (Span::new(file, 2, 4), Span::new(file, 8, 9));
        assert_eq!(a.merge(b), Span::new(file, 2, 9));
        assert_eq!(Span::NONE.merge(b), b);
        assert_eq!(b.merge(Span::NONE), b);
        assert_eq!(a.merge(Span::new(FileId(1), 0, 1)), a);
    }
}
