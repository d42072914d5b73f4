//! Documents that can be laid out on one line or on several lines, and the layout algorithm.
//!
//! After Wadler, "A prettier printer", with two additions: a suffix is printed at the end of its line, and the suffixes
//! of adjacent lines are aligned in one column.

/// Maximum line width in characters. Single tokens and comments may exceed it.
pub(super) const MAX_WIDTH: usize = 100;

/// Maximum indentation in columns. Deeper nodes are not indented further.
// Without a limit, the text of a deeply nested program would grow with the square of its size.
const MAX_INDENT: usize = 80;

/// Document: text with optional line breaks, among which the layout algorithm chooses.
#[derive(Clone, Debug)]
pub(super) enum Doc {
    /// Text of one or several tokens.
    Text(String),
    /// Static text of one or several tokens.
    Word(&'static str),
    /// Line break if the enclosing group is broken, else a space.
    Line,
    /// Line break if the enclosing group is broken, else no text.
    SoftLine,
    /// Line break in any case. All enclosing groups are broken.
    HardLine,
    /// Empty line, used at the beginning of a line. All enclosing groups are broken.
    EmptyLine,
    /// Comment that is moved to the end of the current line. All enclosing groups are broken.
    LineSuffix(String),
    /// Documents one after the other.
    Concat(Vec<Doc>),
    /// Document whose lines are indented by a number of columns.
    Indent(usize, Box<Doc>),
    /// Document in which lines after a comment are indented by two steps instead of one.
    Hang(Box<Doc>),
    /// Mark without text: source offset in bytes of the text that follows.
    SourceOffset(u32),
    /// Document that is laid out on one line, regardless of its width.
    Flat(Box<Doc>),
    /// Document on one line if it fits. Otherwise the group is broken at each `Line` and `SoftLine` directly in it.
    Group(Box<Doc>),
}

/// Indentation of one nesting level, in columns.
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
    /// Returns whether the document has no text.
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

    /// Returns the width in characters of the document on one line; [`None`] if it has a line break or is wider than
    /// [`MAX_WIDTH`].
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

/// Returns the text of a document, with `\n` at the end of each line.
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

/// Layout of a group: on one line, or with its optional line breaks.
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

/// State of the algorithm that lays out a document in lines.
#[derive(Default)]
struct Layout {
    /// Lines that are completely laid out.
    lines: Vec<Line>,
    /// Text of the line that is being laid out, without the comment at its end.
    line: String,
    /// Comments at the end of the line that is being laid out; `None` if there are none.
    suffix: Option<String>,
    /// Whether the last comment in `suffix` extends to the end of its line, so that no further comment can follow.
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
    /// `margin` is its indentation; `rest` holds the following nodes, the next one last.
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

/// Returns whether a comment extends to the end of its line, as comments with `--` do.
fn ends_with_line(comment: &str) -> bool {
    comment.starts_with("--") || comment.starts_with("//")
}

/// Moves the comments at the ends of adjacent lines to one column, two columns after the longest line.
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
