//! Comments, kept beside the tree.

use rpi_diag::Span;

/// What a comment is for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CommentKind {
    /// `-- remark`
    Line,
    /// `--| text`: documentation of the declaration that follows
    Doc,
    /// `--%MAIN`, `--%PROPERTY x;`: a mark for tools
    Pragma,
    /// `(* remark *)`, `/* remark */`
    Block,
    /// `(*@contract ... *)`: a contract in the manner of Kind 2, not read
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
    /// The comments that begin at `start` or later and before `end`, as byte offsets.
    pub fn between(&self, start: u32, end: u32) -> &[Comment] {
        let from = self.all.partition_point(|c| c.span.start < start);
        let len = self.all[from..].partition_point(|c| c.span.start < end);
        &self.all[from..from + len]
    }
}
