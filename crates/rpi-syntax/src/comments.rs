//! Comments, stored separately from the syntax tree.

use crate::ast::Doc;
use rpi_diag::Span;

/// Syntax of a comment, which decides whether it ends with its line and whether it is documentation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CommentKind {
    /// Comment up to the end of its line: `-- remark`
    Line,
    /// Documentation of the next declaration: `--| text`
    Doc,
    /// Pragma for other tools: `--%MAIN`
    Pragma,
    /// Property of Kind 2 that the parser does not read as a statement: `--%PROPERTY x;`
    Property,
    /// Comment with an end marker: `(* remark *)`, `/* remark */`
    Block,
    /// Contract of Kind 2 that the parser does not read as a contract: `(*@contract ... *)`
    Contract,
}

/// Comment with its source range.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Comment {
    /// Syntax in which the comment is written.
    pub kind: CommentKind,
    /// Source range of the comment, comment markers included.
    pub span: Span,
}

/// Comments of a source file in text order.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Comments {
    /// All comments in text order.
    pub all: Vec<Comment>,
}

impl Comments {
    /// Returns whether the file has any doc comment (`--|`).
    pub(crate) fn has_docs(&self) -> bool {
        self.all.iter().any(|c| c.kind == CommentKind::Doc)
    }

    /// Returns the text of the doc comments directly before the byte offset `start`, lines joined by `\n`; `None` if
    /// there are none.
    ///
    /// At most one line break may lie between two of these comments, and between the last one and `start`.
    pub(crate) fn doc_before(&self, text: &str, start: u32) -> Option<Doc> {
        let end = self.all.partition_point(|c| c.span.start < start);
        let mut next = start;
        let mut lines = Vec::new();
        for comment in self.all[..end].iter().rev() {
            let gap = &text[comment.span.end as usize..next as usize];
            if comment.kind != CommentKind::Doc || !is_single_line_break(gap) {
                break;
            }
            lines.push(doc_line(text, comment.span));
            next = comment.span.start;
        }
        lines.reverse();
        (!lines.is_empty()).then(|| lines.join("\n").into())
    }

    /// Returns the comments that begin in `start..end` (byte offsets).
    pub fn between(&self, start: u32, end: u32) -> &[Comment] {
        let from = self.all.partition_point(|c| c.span.start < start);
        let len = self.all[from..].partition_point(|c| c.span.start < end);
        &self.all[from..from + len]
    }
}

/// Returns whether the text is white space with at most one line break.
fn is_single_line_break(gap: &str) -> bool {
    gap.trim().is_empty() && gap.matches('\n').count() <= 1
}

/// Returns the text of a doc comment after its marker `--|`, without one leading space. `span` is the place of the
/// comment in the file.
fn doc_line(text: &str, span: Span) -> &str {
    let line = &text[span.start as usize + 3..span.end as usize];
    line.strip_prefix(' ').unwrap_or(line).trim_end()
}
