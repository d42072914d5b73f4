//! Documents that can be laid out on one line or on several lines, and the layout algorithm.
//!
//! After Wadler, "A prettier printer", with two additions: a suffix is printed at the end of its line, and the suffixes
//! of adjacent lines are aligned in one column.

/// Maximum line width in characters. Single tokens and comments may exceed it.
pub(super) const MAX_WIDTH: usize = 100;

/// Maximum indentation in columns.
// Without a limit, the text of a deeply nested program would grow with the square of its size.
const MAX_INDENT: usize = 80;

/// Document: text with alternative layouts, from which the printer chooses.
#[derive(Clone, Debug)]
pub(super) enum Doc {
    /// Text of one or several tokens.
    Text(String),
    /// Static text of one or several tokens.
    Word(&'static str),
    /// Line break in a broken group, else a space.
    Line,
    /// Line break in a broken group, else no text.
    SoftLine,
    /// Line break; breaks every enclosing group.
    HardLine,
    /// Empty line, at the beginning of a line; breaks every enclosing group.
    EmptyLine,
    /// Comment at the end of the current line; breaks every enclosing group.
    LineSuffix(String),
    /// Documents one after the other.
    Concat(Vec<Doc>),
    /// Document whose lines are indented by a number of columns.
    Indent(usize, Box<Doc>),
    /// Document in which lines after a comment are indented by one more step.
    Hang(Box<Doc>),
    /// Source offset of the following text.
    SourceOffset(u32),
    /// Document on one line, regardless of its width.
    Flat(Box<Doc>),
    /// Document on one line if it fits, else broken at each `Line` and `Soft` directly in it.
    Group(Box<Doc>),
}

/// Indentation of the content of blocks, in columns.
pub(super) const INDENT: usize = 2;

pub(super) fn text(text: impl Into<String>) -> Doc {
    Doc::Text(text.into())
}

pub(super) fn word(word: &'static str) -> Doc {
    Doc::Word(word)
}

pub(super) fn concat(parts: impl IntoIterator<Item = Doc>) -> Doc {
    Doc::Concat(parts.into_iter().collect())
}

pub(super) fn empty() -> Doc {
    Doc::Concat(Vec::new())
}

pub(super) fn indent(doc: Doc) -> Doc {
    Doc::Indent(INDENT, Box::new(doc))
}

pub(super) fn group(doc: Doc) -> Doc {
    Doc::Group(Box::new(doc))
}

impl Doc {
    /// Returns whether the document is empty.
    pub(super) fn is_empty(&self) -> bool {
        match self {
            Doc::Concat(parts) => parts.iter().all(Doc::is_empty),
            Doc::Indent(_, doc) | Doc::Hang(doc) | Doc::Group(doc) | Doc::Flat(doc) => {
                doc.is_empty()
            }
            Doc::SourceOffset(_) => true,
            Doc::Text(text) => text.is_empty(),
            _ => false,
        }
    }

    /// Returns the width of the document on one line; [`None`] if it has a line break or is wider than [`MAX_WIDTH`].
    pub(super) fn flat_width(&self) -> Option<usize> {
        let mut left = MAX_WIDTH;
        let mut todo = vec![self];
        while let Some(doc) = todo.pop() {
            let width = match doc {
                Doc::Text(text) => text.chars().count(),
                Doc::Word(word) => word.len(),
                Doc::Line => 1,
                Doc::SoftLine | Doc::SourceOffset(_) => 0,
                Doc::HardLine | Doc::EmptyLine | Doc::LineSuffix(_) => return None,
                Doc::Concat(parts) => {
                    todo.extend(parts.iter().rev());
                    0
                }
                Doc::Indent(_, doc) | Doc::Hang(doc) | Doc::Group(doc) | Doc::Flat(doc) => {
                    todo.push(doc);
                    0
                }
            };
            left = left.checked_sub(width)?;
        }
        Some(MAX_WIDTH - left)
    }
}

/// Lays out a document as text, with `\n` at the end of each line.
pub(super) fn lay_out(doc: &Doc) -> String {
    let mut layout = Layout::default();
    layout.run(doc);
    layout.end_line();
    align_suffixes(&mut layout.lines);
    let mut out = String::new();
    for line in &layout.lines {
        out.push_str(&line.code);
        if let Some(suffix) = &line.suffix {
            out.push_str(suffix);
        }
        out.push('\n');
    }
    out
}

/// Whether the optional line breaks of a group are used, or the group is on one line.
#[derive(Clone, Copy, PartialEq, Eq)]
enum BreakMode {
    Flat,
    Broken,
}

#[derive(Default)]
struct Line {
    code: String,
    suffix: Option<String>,
}

/// State of the layout algorithm.
#[derive(Default)]
struct Layout {
    /// Finished lines.
    lines: Vec<Line>,
    /// Current line.
    line: String,
    /// Comment at the end of the current line.
    suffix: Option<String>,
    /// Whether the last comment of `suffix` is a line comment.
    suffix_takes_line: bool,
    /// Number of characters in `line`.
    column: usize,
    /// Indentation of the next line, in columns.
    margin: usize,
}

impl Layout {
    fn run(&mut self, doc: &Doc) {
        let mut todo = vec![(0, BreakMode::Broken, doc)];
        while let Some((margin, mode, doc)) = todo.pop() {
            match doc {
                Doc::Text(text) => self.text(text),
                Doc::Word(word) => self.text(word),
                Doc::Line | Doc::HardLine if mode == BreakMode::Flat => self.text(" "),
                Doc::SoftLine if mode == BreakMode::Flat => {}
                Doc::SourceOffset(_) => {}
                Doc::Line | Doc::SoftLine | Doc::HardLine => self.break_line(margin),
                Doc::EmptyLine => self.end_line(),
                Doc::LineSuffix(comment) => self.suffix(comment),
                Doc::Concat(parts) => {
                    todo.extend(parts.iter().rev().map(|part| (margin, mode, part)))
                }
                Doc::Indent(by, doc) => todo.push(((margin + by).min(MAX_INDENT), mode, doc)),
                Doc::Hang(doc) => todo.push((margin, mode, doc)),
                Doc::Flat(doc) => todo.push((margin, BreakMode::Flat, doc)),
                Doc::Group(doc) => {
                    let mode = match mode == BreakMode::Flat || self.fits(margin, doc, &todo) {
                        true => BreakMode::Flat,
                        false => BreakMode::Broken,
                    };
                    todo.push((margin, mode, doc));
                }
            }
        }
    }

    /// Returns whether a group on one line, with the text after it up to the next line break, fits into the line.
    fn fits(&self, margin: usize, group: &Doc, rest: &[(usize, BreakMode, &Doc)]) -> bool {
        let used = if self.line.is_empty() {
            margin
        } else {
            self.column
        };
        let mut left = MAX_WIDTH.saturating_sub(used);
        let mut todo = vec![(BreakMode::Flat, group)];
        let mut rest = rest.iter().rev();
        loop {
            let Some((mode, doc)) = todo
                .pop()
                .or_else(|| rest.next().map(|(_, mode, doc)| (*mode, *doc)))
            else {
                return true;
            };
            let width = match doc {
                Doc::Text(text) => text.chars().count(),
                Doc::Word(word) => word.len(),
                Doc::Line if mode == BreakMode::Flat => 1,
                Doc::SoftLine if mode == BreakMode::Flat => 0,
                Doc::SourceOffset(_) => 0,
                Doc::Line | Doc::SoftLine => return true,
                Doc::HardLine | Doc::EmptyLine | Doc::LineSuffix(_) => {
                    return mode == BreakMode::Broken;
                }
                Doc::Concat(parts) => {
                    todo.extend(parts.iter().rev().map(|part| (mode, part)));
                    0
                }
                Doc::Indent(_, doc) | Doc::Hang(doc) | Doc::Group(doc) => {
                    todo.push((mode, doc));
                    0
                }
                Doc::Flat(doc) => {
                    todo.push((BreakMode::Flat, doc));
                    0
                }
            };
            match left.checked_sub(width) {
                Some(less) => left = less,
                None => return false,
            }
        }
    }

    fn text(&mut self, text: &str) {
        if text.is_empty() {
            return;
        }
        if self.line.is_empty() {
            self.line.extend(std::iter::repeat_n(' ', self.margin));
            self.column = self.margin;
        }
        self.line.push_str(text);
        self.column += text.chars().count();
    }

    fn suffix(&mut self, comment: &str) {
        match &mut self.suffix {
            // After a line comment on the same line, it would become part of that comment.
            Some(_) if self.suffix_takes_line && !ends_with_line(comment) => {
                self.end_line();
                self.text(comment);
                return;
            }
            Some(suffix) => {
                suffix.push(' ');
                suffix.push_str(comment);
            }
            None => self.suffix = Some(comment.to_owned()),
        }
        self.suffix_takes_line = ends_with_line(comment);
    }

    fn break_line(&mut self, margin: usize) {
        self.end_line();
        self.margin = margin;
    }

    fn end_line(&mut self) {
        let code = std::mem::take(&mut self.line);
        self.column = 0;
        self.lines.push(Line {
            code: code.trim_end().to_owned(),
            suffix: self.suffix.take(),
        });
    }
}

/// Returns whether a comment is a line comment, which extends to the end of its line.
fn ends_with_line(comment: &str) -> bool {
    comment.starts_with("--") || comment.starts_with("//")
}

/// Aligns the suffixes of adjacent lines in one column, two columns after the longest line.
fn align_suffixes(lines: &mut [Line]) {
    for run in lines.chunk_by_mut(|a, b| a.suffix.is_some() && b.suffix.is_some()) {
        let longest = run.iter().map(|line| line.code.chars().count()).max();
        for line in run.iter_mut().filter(|line| line.suffix.is_some()) {
            let gap = longest.unwrap_or(0) - line.code.chars().count() + 2;
            line.code.extend(std::iter::repeat_n(' ', gap));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(elements: &[&'static str]) -> Doc {
        let mut parts = vec![Doc::SoftLine];
        for (i, element) in elements.iter().enumerate() {
            parts.extend((i > 0).then_some(concat([word(","), Doc::Line])));
            parts.push(word(element));
        }
        group(concat([
            word("("),
            indent(concat(parts)),
            Doc::SoftLine,
            word(")"),
        ]))
    }

    #[test]
    fn a_group_breaks_if_it_does_not_fit() {
        assert_eq!(lay_out(&list(&["a", "b"])), "(a, b)\n");
        let long = "a_name_of_sixty_characters_a_name_of_sixty_characters_a_name";
        assert_eq!(
            lay_out(&list(&[long, long])),
            format!("(\n  {long},\n  {long}\n)\n")
        );
    }

    #[test]
    fn what_breaks_inside_breaks_outside() {
        let inner = concat([
            word("a"),
            Doc::LineSuffix("-- why".into()),
            Doc::Line,
            word("b"),
        ]);
        assert_eq!(lay_out(&group(inner)), "a  -- why\nb\n");
    }

    #[test]
    fn suffixes_of_adjacent_lines_stand_in_one_column() {
        let line =
            |code, why: &str| concat([word(code), Doc::LineSuffix(why.into()), Doc::HardLine]);
        let doc = concat([
            line("x", "-- 1"),
            line("long", "-- 2"),
            word("y"),
            Doc::HardLine,
            line("z", "-- 3"),
        ]);
        assert_eq!(lay_out(&doc), "x     -- 1\nlong  -- 2\ny\nz  -- 3\n\n");
    }
}
