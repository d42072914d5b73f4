//! Comments, kept beside the tree.

use crate::ast::Doc;
use rpi_diag::Span;

/// What a comment is for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CommentKind {
    /// `-- remark`
    Line,
    /// `--| text`: documentation of the declaration that follows
    Doc,
    /// `--%MAIN`: a mark for tools
    Pragma,
    /// `--%PROPERTY x;`: a property in the manner of Kind 2 that is not read
    Property,
    /// `(* remark *)`, `/* remark */`
    Block,
    /// `(*@contract ... *)`: a contract in the manner of Kind 2 that is not read
    Contract,
}

/// A comment at its place.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Comment {
    /// What it is for.
    pub kind: CommentKind,
    /// All of it, marks included.
    pub span: Span,
}

/// The comments of a file in text order.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Comments {
    /// All of them, in text order.
    pub all: Vec<Comment>,
}

impl Comments {
    /// Whether any of them is documentation.
    pub(crate) fn has_docs(&self) -> bool {
        self.all.iter().any(|c| c.kind == CommentKind::Doc)
    }

    /// The text of the doc comments that end right before `start`, lines joined by `\n`.
    ///
    /// Between them, and before `start`, at most the end of one line may stand.
    pub(crate) fn doc_before(&self, text: &str, start: u32) -> Option<Doc> {
        let end = self.all.partition_point(|c| c.span.start < start);
        let mut next = start;
        let mut lines = Vec::new();
        for comment in self.all[..end].iter().rev() {
            let gap = &text[comment.span.end as usize..next as usize];
            if comment.kind != CommentKind::Doc || !is_one_break(gap) {
                break;
            }
            lines.push(doc_line(text, comment.span));
            next = comment.span.start;
        }
        lines.reverse();
        (!lines.is_empty()).then(|| lines.join("\n").into())
    }

    /// The comments that begin at `start` or later and before `end`, as byte offsets.
    pub fn between(&self, start: u32, end: u32) -> &[Comment] {
        let from = self.all.partition_point(|c| c.span.start < start);
        let len = self.all[from..].partition_point(|c| c.span.start < end);
        &self.all[from..from + len]
    }
}

/// Whether the text is white and ends one line at most.
fn is_one_break(gap: &str) -> bool {
    gap.trim().is_empty() && gap.matches('\n').count() <= 1
}

/// What stands after `--|`, without the space that sets it off.
fn doc_line(text: &str, span: Span) -> &str {
    let line = &text[span.start as usize + 3..span.end as usize];
    line.strip_prefix(' ').unwrap_or(line).trim_end()
}
