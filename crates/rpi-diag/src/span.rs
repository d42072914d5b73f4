//! Locations in source texts: files, byte ranges, lines and columns.

use std::fmt;

/// Identifier of a source text: its index in a [`SourceMap`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub struct FileId(pub u32);

/// Range of bytes `start..end` in one source file.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub struct Span {
    /// File that contains the range.
    pub file: FileId,
    /// Offset of the first byte of the range in the file.
    pub start: u32,
    /// Offset of the byte after the range in the file.
    pub end: u32,
}

impl Span {
    /// Location of an item without source text, such as a built-in declaration or a generated net.
    pub const NONE: Span = Span {
        file: FileId(u32::MAX),
        start: 0,
        end: 0,
    };

    /// Creates the range `start..end` of `file`, in bytes.
    pub const fn new(file: FileId, start: u32, end: u32) -> Span {
        Span { file, start, end }
    }

    /// Returns the smallest range that contains both ranges. If one of them is [`Span::NONE`], the other is returned;
    /// if the files differ, `self`, because a range cannot span files.
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

    /// Returns whether the range `other` lies within this range of the same file.
    #[must_use]
    pub fn contains(self, other: Span) -> bool {
        self.file == other.file && self.start <= other.start && other.end <= self.end
    }

    /// Returns whether the range contains no byte.
    pub fn is_empty(self) -> bool {
        self.start >= self.end
    }

    /// Returns whether this is [`Span::NONE`], the location of an item without source text.
    pub fn is_none(self) -> bool {
        self.file == Span::NONE.file
    }
}

/// Position in a source file as line and column.
#[derive(Clone, Copy, PartialEq, Eq, Debug, PartialOrd, Ord)]
pub struct LineCol {
    /// Line in the source file, counted from 1.
    pub line: u32,
    /// Column in the line, counted from 1 in Unicode scalar values.
    pub col: u32,
}

impl fmt::Display for LineCol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.col)
    }
}

/// Source texts of one compilation, with their names.
#[derive(Clone, Debug, Default)]
pub struct SourceMap {
    files: Vec<SourceFile>,
    /// Parts into which files are divided, in ascending order of their identifiers.
    parts: Vec<SourcePart>,
}

/// Part of a source text that has an identifier of its own. A location in a part is relative to the start of the part,
/// so that it stays the same when the text of another part changes.
#[derive(Clone, Copy, Debug)]
pub struct SourcePart {
    /// Identifier of the part, by which locations refer to it.
    pub id: FileId,
    /// File that contains the part.
    pub file: FileId,
    /// Offset of the first byte of the part in the file.
    pub start: u32,
}

#[derive(Clone, Debug)]
struct SourceFile {
    name: String,
    text: String,
    /// Offsets in bytes of the starts of all lines; the first is 0.
    line_starts: Vec<usize>,
}

impl SourceMap {
    /// Creates a map without source texts.
    pub fn new() -> SourceMap {
        SourceMap::default()
    }

    /// Adds a source text with the name that messages show for it, and returns its identifier.
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

    /// Replaces the parts into which files are divided. `parts` are in ascending order of their identifiers, which is also
    /// the order of their files and starts. The identifiers differ from those of all files.
    pub fn set_parts(&mut self, parts: Vec<SourcePart>) {
        self.parts = parts;
    }

    /// Converts a location in a part of a file to the location in the whole file. Other locations are returned unchanged.
    #[must_use]
    pub fn in_whole_file(&self, span: Span) -> Span {
        match self.part(span.file) {
            Some(part) => Span::new(part.file, span.start + part.start, span.end + part.start),
            None => span,
        }
    }

    /// Converts a location in a whole file to the location in the part that contains its start. The location is returned
    /// unchanged if the file has no parts.
    #[must_use]
    pub fn in_part(&self, span: Span) -> Span {
        let not_after = |part: &SourcePart| (part.file, part.start) <= (span.file, span.start);
        let next = self.parts.partition_point(not_after);
        let part = next.checked_sub(1).map(|at| self.parts[at]);
        match part.filter(|part| part.file == span.file) {
            Some(part) => Span::new(part.id, span.start - part.start, span.end - part.start),
            None => span,
        }
    }

    fn part(&self, id: FileId) -> Option<&SourcePart> {
        let found = self.parts.binary_search_by_key(&id, |part| part.id).ok()?;
        Some(&self.parts[found])
    }

    /// Adds all files of another map, except those already present with the same name and text. Returns the new
    /// identifier of each file of the other map, in its order.
    pub fn absorb(&mut self, other: &SourceMap) -> Vec<FileId> {
        let mut taken = Vec::with_capacity(other.files.len());
        for file in &other.files {
            let same = |id: &FileId| self.name(*id) == file.name && self.text(*id) == file.text;
            let known = self.files().find(same);
            taken.push(known.unwrap_or_else(|| self.add(file.name.clone(), file.text.clone())));
        }
        taken
    }

    /// Returns the name of a file; empty if the file is not in the map.
    pub fn name(&self, id: FileId) -> &str {
        let whole = self.part(id).map_or(id, |part| part.file);
        self.file(whole).map_or("", |f| &f.name)
    }

    /// Returns the text of a file; empty if the file is not in the map.
    pub fn text(&self, id: FileId) -> &str {
        self.file(id).map_or("", |f| &f.text)
    }

    /// Returns the identifiers of all files in the order in which they were added.
    pub fn files(&self) -> impl Iterator<Item = FileId> + '_ {
        (0..self.files.len()).map(|i| FileId(i as u32))
    }

    /// Returns the source text of a range, clamped to the file and to character boundaries; empty if the file is not in
    /// the map.
    pub fn slice(&self, span: Span) -> &str {
        let span = self.in_whole_file(span);
        let (start, end) = self.clamp(span);
        &self.text(span.file)[start..end]
    }

    /// Returns the line and column of the start of a range; `1:1` if the file is not in the map.
    pub fn line_col(&self, span: Span) -> LineCol {
        self.line_col_at(span.file, self.clamp(span).0)
    }

    /// Returns the line and column just after the last character of a range; `1:1` if the file is not in the map.
    pub fn line_col_end(&self, span: Span) -> LineCol {
        self.line_col_at(span.file, self.clamp(span).1)
    }

    /// Clamps a range to the text of its file and to character boundaries. Returns the offsets of start and end in
    /// bytes.
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

/// Returns the largest offset of a character boundary of `text` that is at most `offset`, in bytes.
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
    fn locations_in_parts_are_relative_to_the_part() {
        let (mut sources, file) = one("ab cd ef");
        let parts = [(7, 3), (9, 6)].map(|(id, start)| SourcePart {
            id: FileId(id),
            file,
            start,
        });
        sources.set_parts(parts.to_vec());
        let of_part = |id, start, end| Span::new(FileId(id), start, end);
        assert_eq!(sources.slice(of_part(9, 0, 2)), "ef");
        assert_eq!(sources.slice(of_part(0, 0, 2)), "ab");
        assert_eq!(sources.name(FileId(7)), "a.rpi");
        let whole = Span::new(file, 3, 5);
        assert_eq!(sources.in_whole_file(of_part(7, 0, 2)), whole);
        assert_eq!(sources.in_part(whole), of_part(7, 0, 2));
        assert_eq!(sources.in_whole_file(Span::NONE), Span::NONE);
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
