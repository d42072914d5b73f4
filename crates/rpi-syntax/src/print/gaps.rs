//! Where the comments of a source stand: between which tokens, and on whose line.

use super::pieces::is_separator;
use crate::comments::{Comment, CommentKind};
use crate::lexer::Lexeme;
use rpi_diag::Span;

/// The tokens of a source, with the comments between them.
pub(super) struct Source<'a> {
    pub(super) text: &'a str,
    pub(super) comments: &'a [Comment],
    /// All tokens that take room.
    tokens: Vec<Span>,
    /// Which of them are no separators.
    significant: Vec<usize>,
}

/// The comments between two tokens.
pub(super) struct Gap<'a> {
    /// Where what stands behind them begins in the source, separators aside.
    pub(super) next: u32,
    /// Those that end the line of the token before it.
    pub(super) behind: Vec<&'a Comment>,
    /// The comment that stands before a separator or closing sign, on the line of both.
    pub(super) within: Vec<&'a Comment>,
    /// Those on lines of their own.
    pub(super) own: Vec<&'a Comment>,
    /// Those that begin the line of the token behind it, or stand in it.
    pub(super) ahead: Vec<&'a Comment>,
}

impl<'a> Source<'a> {
    pub(super) fn new(text: &'a str, lexemes: &[Lexeme], comments: &'a [Comment]) -> Source<'a> {
        let span = |lexeme: &Lexeme| Span {
            start: lexeme.start,
            end: lexeme.end,
            ..Span::NONE
        };
        let tokens: Vec<Span> = lexemes
            .iter()
            .map(span)
            .filter(|s| s.start < s.end)
            .collect();
        let is_significant = |i: &usize| !is_separator(slice(text, tokens[*i]));
        let significant = (0..tokens.len()).filter(is_significant).collect();
        Source {
            text,
            comments,
            tokens,
            significant,
        }
    }

    /// The tokens that are no separators.
    pub(super) fn words(&self) -> Vec<&'a str> {
        let words = self.significant.iter();
        words.map(|i| slice(self.text, self.tokens[*i])).collect()
    }

    /// The first of them that does not begin before an offset.
    pub(super) fn word_at(&self, offset: u32) -> usize {
        self.significant
            .partition_point(|i| self.tokens[*i].start < offset)
    }

    fn start_of(&self, word: usize) -> u32 {
        let token = self.significant.get(word).map(|i| self.tokens[*i]);
        token.map_or(self.text.len() as u32, |token| token.start)
    }

    /// Whether an empty line stands in the source between two offsets.
    pub(super) fn is_blank(&self, from: u32, to: u32) -> bool {
        self.line_ends(from, to) > 1
    }

    /// Whether a doc comment that ends at `from` documents what begins at `to`, or goes on there.
    pub(super) fn documents(&self, from: u32, to: u32) -> bool {
        let gap = self.text.get(from as usize..to as usize).unwrap_or("");
        gap.trim().is_empty() && self.line_ends(from, to) <= 1
    }

    /// Where what stands before a place ends, comments aside.
    fn end_before(&self, offset: u32) -> u32 {
        self.token_before(offset).map_or(0, |token| token.end)
    }

    /// The token before a place, if there is one.
    pub(super) fn token_before(&self, offset: u32) -> Option<Span> {
        let before = self.tokens.partition_point(|token| token.start < offset);
        before.checked_sub(1).map(|i| self.tokens[i])
    }

    /// What is written at a place or next behind it, comments aside.
    pub(super) fn token_from(&self, offset: u32) -> &str {
        let at = self.tokens.partition_point(|token| token.start < offset);
        let token = self.tokens.get(at);
        token.map_or("", |token| slice(self.text, *token))
    }

    fn line_ends(&self, from: u32, to: u32) -> usize {
        let gap = self.text.get(from as usize..to as usize).unwrap_or("");
        gap.bytes().filter(|b| *b == b'\n').count()
    }

    /// Comments that come to stand between the same two tokens; whether the second one ends what another began.
    pub(super) fn gap(&self, all: &'a [Comment], closes: bool) -> Gap<'a> {
        let word = |c: Option<&Comment>| c.map_or(0, |c| self.word_at(c.span.start));
        let (mut behind, mut within, mut own) = (Vec::new(), Vec::new(), Vec::new());
        let leads = |comment: &&Comment| !closes && self.leads(comment);
        let inline = all.iter().rev().take_while(leads).count();
        let (rest, ahead) = all.split_at(all.len() - inline);
        let mut on_line = word(all.first()) > 0;
        for comment in rest {
            on_line &= self.line_ends(self.reached(comment), comment.span.start) == 0;
            match on_line {
                true if behind.is_empty() && self.is_within(comment) => within.push(comment),
                true if !self.documents_next(comment) => behind.push(comment),
                _ => own.push(comment),
            }
            on_line &= matches!(comment.kind, CommentKind::Block | CommentKind::Contract);
        }
        Gap {
            next: self.start_of(word(all.last())),
            behind,
            within,
            own,
            ahead: ahead.iter().collect(),
        }
    }

    /// Where what stands before a comment ends.
    pub(super) fn reached(&self, comment: &Comment) -> u32 {
        let at = self
            .comments
            .partition_point(|c| c.span.start < comment.span.start);
        let previous = at.checked_sub(1).map_or(0, |i| self.comments[i].span.end);
        previous.max(self.end_before(comment.span.start))
    }

    /// What stands behind a comment: a token, if no other comment stands before it.
    fn next(&self, comment: &Comment) -> Option<Span> {
        let at = self
            .tokens
            .partition_point(|t| t.start < comment.span.start);
        self.tokens.get(at).copied()
    }

    /// Whether a comment stands in the line of the word behind it.
    fn leads(&self, comment: &Comment) -> bool {
        let next = self.next(comment);
        self.is_within(comment) && next.is_some_and(|next| !is_separator(slice(self.text, next)))
    }

    /// Whether a comment stands in the line of the token behind it.
    fn is_within(&self, comment: &Comment) -> bool {
        let next = self.next(comment);
        self.is_short(comment)
            && next.is_some_and(|next| self.line_ends(comment.span.end, next.start) == 0)
    }

    /// Whether it documents what begins on the next line.
    fn documents_next(&self, comment: &Comment) -> bool {
        let next = self.next(comment).map(|next| next.start);
        comment.kind == CommentKind::Doc
            && next.is_some_and(|next| self.documents(comment.span.end, next))
    }

    fn is_short(&self, comment: &Comment) -> bool {
        comment.kind == CommentKind::Block && !slice(self.text, comment.span).contains('\n')
    }

    pub(super) fn written(&self, comment: &Comment) -> String {
        slice(self.text, comment.span).trim_end().to_owned()
    }
}

/// Whether it ends what another token began.
pub(super) fn is_closer(token: &str) -> bool {
    matches!(token, ")" | "]" | "}" | ">>" | "tel" | "noc" | "end" | "fi")
}

fn slice(text: &str, span: Span) -> &str {
    text.get(span.start as usize..span.end as usize)
        .unwrap_or("")
}
