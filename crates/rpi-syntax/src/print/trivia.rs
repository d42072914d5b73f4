//! Positions of the comments of a source: the tokens around each comment, and the line that it shares with them.

use super::flat_doc::is_separator;
use crate::comments::{Comment, CommentKind};
use crate::lexer::Lexeme;
use rpi_diag::Span;

/// Source text with its tokens and comments. A word is a token other than `,` and `;`.
pub(super) struct Source<'a> {
    pub(super) text: &'a str,
    pub(super) comments: &'a [Comment],
    /// Spans of all tokens that are not empty.
    tokens: Vec<Span>,
    /// Indices into `tokens` of the words.
    significant: Vec<usize>,
}

/// Comments between two words of the source, by their position relative to the words and line breaks.
pub(super) struct GapComments<'a> {
    /// Source offset in bytes of the word after the comments.
    pub(super) next: u32,
    /// Comments after the previous word on its line.
    pub(super) trailing: Vec<&'a Comment>,
    /// Comments between the previous word and a separator or closing bracket on the same line.
    pub(super) before_separator: Vec<&'a Comment>,
    /// Comments that share their line with no code.
    pub(super) own_line: Vec<&'a Comment>,
    /// Comments before the next word on its line.
    pub(super) leading: Vec<&'a Comment>,
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

    /// Returns the texts of the words, which are the tokens other than `,` and `;`.
    pub(super) fn significant_texts(&self) -> Vec<&'a str> {
        let words = self.significant.iter();
        words.map(|i| slice(self.text, self.tokens[*i])).collect()
    }

    /// Returns the index of the first word that begins at or after the byte offset `offset`.
    pub(super) fn word_at(&self, offset: u32) -> usize {
        self.significant
            .partition_point(|i| self.tokens[*i].start < offset)
    }

    /// Returns the byte offset of the word with the index `word`; the length of the source for an index past the last
    /// one.
    fn start_of(&self, word: usize) -> u32 {
        let token = self.significant.get(word).map(|i| self.tokens[*i]);
        token.map_or(self.text.len() as u32, |token| token.start)
    }

    /// Returns whether the source has an empty line between two byte offsets.
    pub(super) fn has_blank_line(&self, from: u32, to: u32) -> bool {
        self.line_ends(from, to) > 1
    }

    /// Returns whether a doc comment that ends at byte offset `from` belongs to the declaration or doc comment at `to`:
    /// at most one line break lies between them.
    pub(super) fn documents(&self, from: u32, to: u32) -> bool {
        let gap = self.text.get(from as usize..to as usize).unwrap_or("");
        gap.trim().is_empty() && self.line_ends(from, to) <= 1
    }

    /// Returns the end of the last token that begins before the byte offset `offset`; 0 if there is none.
    fn end_before(&self, offset: u32) -> u32 {
        self.token_before(offset).map_or(0, |token| token.end)
    }

    /// Returns the span of the last token that begins before the byte offset `offset`.
    pub(super) fn token_before(&self, offset: u32) -> Option<Span> {
        let before = self.tokens.partition_point(|token| token.start < offset);
        before.checked_sub(1).map(|i| self.tokens[i])
    }

    /// Returns the text of the first token at or after the byte offset `offset`; empty if there is none.
    pub(super) fn token_from(&self, offset: u32) -> &str {
        let at = self.tokens.partition_point(|token| token.start < offset);
        let token = self.tokens.get(at);
        token.map_or("", |token| slice(self.text, *token))
    }

    fn line_ends(&self, from: u32, to: u32) -> usize {
        let gap = self.text.get(from as usize..to as usize).unwrap_or("");
        gap.bytes().filter(|b| *b == b'\n').count()
    }

    /// Classifies the comments `all` between two words by their position. `closes` is true if the second word closes a
    /// bracket or block.
    pub(super) fn classify(&self, all: &'a [Comment], closes: bool) -> GapComments<'a> {
        let word = |c: Option<&Comment>| c.map_or(0, |c| self.word_at(c.span.start));
        let (mut behind, mut within, mut own) = (Vec::new(), Vec::new(), Vec::new());
        let leads = |comment: &&Comment| !closes && self.is_leading(comment);
        let inline = all.iter().rev().take_while(leads).count();
        let (rest, ahead) = all.split_at(all.len() - inline);
        let mut on_line = word(all.first()) > 0;
        for comment in rest {
            on_line &= self.line_ends(self.previous_end(comment), comment.span.start) == 0;
            match on_line {
                true if behind.is_empty() && self.is_within(comment) => within.push(comment),
                true if !self.documents_next(comment) => behind.push(comment),
                _ => own.push(comment),
            }
            on_line &= matches!(comment.kind, CommentKind::Block | CommentKind::Contract);
        }
        GapComments {
            next: self.start_of(word(all.last())),
            trailing: behind,
            before_separator: within,
            own_line: own,
            leading: ahead.iter().collect(),
        }
    }

    /// Returns the byte offset of the end of the token or comment before `comment`.
    pub(super) fn previous_end(&self, comment: &Comment) -> u32 {
        let at = self
            .comments
            .partition_point(|c| c.span.start < comment.span.start);
        let previous = at.checked_sub(1).map_or(0, |i| self.comments[i].span.end);
        previous.max(self.end_before(comment.span.start))
    }

    /// Returns the span of the first token after a comment; `None` at the end of the source.
    fn next(&self, comment: &Comment) -> Option<Span> {
        let at = self
            .tokens
            .partition_point(|t| t.start < comment.span.start);
        self.tokens.get(at).copied()
    }

    /// Returns whether a comment is a block comment on the line of the next token, and that token is neither `,` nor
    /// `;`.
    fn is_leading(&self, comment: &Comment) -> bool {
        let next = self.next(comment);
        self.is_within(comment) && next.is_some_and(|next| !is_separator(slice(self.text, next)))
    }

    /// Returns whether a comment is a block comment on one line, which is also the line of the next token.
    fn is_within(&self, comment: &Comment) -> bool {
        let next = self.next(comment);
        self.is_short(comment)
            && next.is_some_and(|next| self.line_ends(comment.span.end, next.start) == 0)
    }

    /// Returns whether a comment is a doc comment that belongs to the token on the next line.
    fn documents_next(&self, comment: &Comment) -> bool {
        let next = self.next(comment).map(|next| next.start);
        comment.kind == CommentKind::Doc
            && next.is_some_and(|next| self.documents(comment.span.end, next))
    }

    /// Returns whether a comment is a block comment without a line break.
    fn is_short(&self, comment: &Comment) -> bool {
        comment.kind == CommentKind::Block && !slice(self.text, comment.span).contains('\n')
    }

    pub(super) fn comment_text(&self, comment: &Comment) -> String {
        slice(self.text, comment.span).trim_end().to_owned()
    }
}

/// Returns whether a token closes a bracket or block.
pub(super) fn is_closer(token: &str) -> bool {
    matches!(token, ")" | "]" | "}" | ">>" | "tel" | "noc" | "end" | "fi")
}

fn slice(text: &str, span: Span) -> &str {
    text.get(span.start as usize..span.end as usize)
        .unwrap_or("")
}
