//! Comments on their way from one text to the other.
//!
//! A comment on the line of a phrase stays at the end of that line. Other comments stand on lines of
//! their own before the phrase that follows them. What stands inside of a phrase moves before it.

use super::layout::{Doc, text};
use crate::comments::{Comment, CommentKind};
use rpi_diag::Span;

/// A comment on lines of its own.
pub(super) struct Own {
    /// Whether an empty line stands before it.
    pub(super) blank_before: bool,
    pub(super) is_doc: bool,
    pub(super) doc: Doc,
}

/// The comments that have not been placed yet.
pub(super) struct Trivia<'a> {
    source: &'a str,
    comments: &'a [Comment],
    /// Where what was placed last ends in the source.
    reached: u32,
    /// Where the doc comment placed last ends.
    doc_end: u32,
}

impl<'a> Trivia<'a> {
    pub(super) fn new(source: &'a str, comments: &'a [Comment]) -> Trivia<'a> {
        Trivia {
            source,
            comments,
            reached: 0,
            doc_end: u32::MAX,
        }
    }

    /// Takes the comments before `end`, each for lines of its own.
    pub(super) fn before(&mut self, end: u32) -> Vec<Own> {
        let mut own = Vec::new();
        while let Some(comment) = self.comments.first().filter(|c| c.span.start < end) {
            own.push(Own {
                blank_before: self.blank_before(comment.span.start),
                is_doc: comment.kind == CommentKind::Doc,
                doc: text(self.written(comment.span)),
            });
            self.take();
        }
        own
    }

    /// Takes the comments after `start`, on the same line and before `limit`, as a suffix.
    pub(super) fn after(&mut self, start: u32, limit: u32) -> Vec<Doc> {
        self.reach(start);
        let mut suffixes = Vec::new();
        while let Some(comment) = self.comments.first()
            && (start..limit).contains(&comment.span.start)
            && !self
                .between(self.reached, comment.span.start)
                .contains('\n')
        {
            suffixes.push(Doc::Suffix(self.written(comment.span).to_owned()));
            let ends_line = !matches!(comment.kind, CommentKind::Block | CommentKind::Contract);
            self.take();
            if ends_line {
                break;
            }
        }
        suffixes
    }

    /// Whether an empty line must stand between what was placed last and `start`: one stood there,
    /// or else a doc comment would become that of something else.
    pub(super) fn blank_before(&self, start: u32) -> bool {
        let gap = self.between(self.reached, start);
        let documents_other = self.reached == self.doc_end && !gap.trim().is_empty();
        documents_other || gap.bytes().filter(|b| *b == b'\n').count() > 1
    }

    /// Where the next token begins after `offset`, separators and comments aside.
    pub(super) fn next_token(&self, offset: u32) -> u32 {
        let mut at = offset;
        let from = self.comments.partition_point(|c| c.span.start < offset);
        let mut comments = self.comments[from..].iter();
        loop {
            let rest = self.source.get(at as usize..).unwrap_or("");
            let blank = rest.len()
                - rest
                    .trim_start_matches([' ', '\t', '\r', '\n', ';', ','])
                    .len();
            at += blank as u32;
            match comments.next() {
                Some(comment) if comment.span.start == at => at = comment.span.end,
                _ => return at,
            }
        }
    }

    /// Whether a comment before `end` has not been placed.
    pub(super) fn any_before(&self, end: u32) -> bool {
        self.comments.first().is_some_and(|c| c.span.start < end)
    }

    /// How far the source has been written.
    pub(super) fn reached(&self) -> u32 {
        self.reached
    }

    /// Notes that the source has been written up to `offset`.
    pub(super) fn reach(&mut self, offset: u32) {
        self.reached = self.reached.max(offset);
    }

    fn take(&mut self) {
        if let Some((comment, rest)) = self.comments.split_first() {
            self.reached = comment.span.end;
            if comment.kind == CommentKind::Doc {
                self.doc_end = comment.span.end;
            }
            self.comments = rest;
        }
    }

    fn written(&self, span: Span) -> &'a str {
        self.between(span.start, span.end).trim_end()
    }

    fn between(&self, start: u32, end: u32) -> &'a str {
        self.source.get(start as usize..end as usize).unwrap_or("")
    }
}
