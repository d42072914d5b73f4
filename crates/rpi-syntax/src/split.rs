//! Splits the tokens of a file into top-level declarations, so that a fault in one can not reach the next.
//!
//! A declaration begins at one of its words where no body or bracket is open. The words of those that
//! never stand inside others begin one even where a `tel` or a bracket is missing before them.

use crate::Mode;
use crate::lexer::Lexeme;
use crate::token::{KEYWORDS, Place, Token};
use rpi_diag::suggest;
use std::ops::Range;

/// A stretch of tokens that is to be one declaration.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Chunk {
    /// Which tokens.
    pub(crate) range: Range<usize>,
    /// What it begins with.
    pub(crate) head: Head,
}

/// What a chunk begins with.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Head {
    /// The word of a declaration.
    Declaration,
    /// A name where such a word is expected, and the word that it resembles.
    Misspelt(Option<Token>),
    /// Anything else.
    Stray,
}

/// Splits a file. Every token is in exactly one chunk.
pub(crate) fn split(text: &str, lexemes: &[Lexeme], mode: Mode) -> Vec<Chunk> {
    let mut splitter = Splitter {
        text,
        lexemes,
        mode,
        chunks: Vec::new(),
        lets: 0,
        brackets: 0,
        complete: true,
    };
    for at in 0..lexemes.len() {
        splitter.token(at);
    }
    splitter.chunks
}

struct Splitter<'t> {
    text: &'t str,
    lexemes: &'t [Lexeme],
    mode: Mode,
    chunks: Vec<Chunk>,
    /// Open bodies and brackets in the current chunk.
    lets: u32,
    brackets: u32,
    /// Whether the current chunk has had its body, or there is none yet.
    complete: bool,
}

impl Splitter<'_> {
    fn token(&mut self, at: usize) {
        match self.head(at) {
            Some(head) => self.begin(at, head),
            None => self.extend(at),
        }
        self.follow(at);
    }

    /// What the token begins, if it does begin a chunk.
    fn head(&self, at: usize) -> Option<Head> {
        if self.begins_declaration(at) {
            return Some(Head::Declaration);
        }
        if self.begins_unknown(at) {
            return Some(Head::Misspelt(self.meant(at)));
        }
        let closes = matches!(self.token_at(at), Some(Token::Semi | Token::Dot));
        (self.complete && (self.chunks.is_empty() || !closes)).then_some(Head::Stray)
    }

    fn begin(&mut self, at: usize, head: Head) {
        // What stands outside of declarations is one chunk, however long.
        if head == Head::Stray && self.chunks.last().is_some_and(|c| c.head == Head::Stray) {
            return self.extend(at);
        }
        self.complete = head == Head::Stray;
        (self.lets, self.brackets) = (0, 0);
        let range = at..at + 1;
        self.chunks.push(Chunk { range, head });
    }

    fn extend(&mut self, at: usize) {
        if let Some(chunk) = self.chunks.last_mut() {
            chunk.range.end = at + 1;
        }
    }

    /// Keeps count of what is open.
    fn follow(&mut self, at: usize) {
        use Token::{
            LBrace, LBracket, LParen, LStatic, Let, RBrace, RBracket, RParen, RStatic, Tel,
        };
        match self.lexemes[at].token {
            Let => (self.lets, self.brackets) = (self.lets + 1, 0),
            Tel => {
                self.complete |= self.lets <= 1;
                (self.lets, self.brackets) = (self.lets.saturating_sub(1), 0);
            }
            LParen | LBracket | LBrace | LStatic => self.brackets += 1,
            RParen | RBracket | RBrace | RStatic => self.brackets = self.brackets.saturating_sub(1),
            _ => {}
        }
    }

    fn begins_declaration(&self, at: usize) -> bool {
        let token = self.lexemes[at].token;
        let outside = self.brackets == 0 || self.begins_line(at);
        begins_declaration(token)
            && outside
            && !self.continues_prefix(at)
            && match token {
                Token::Fragment => self.lets == 0,
                Token::Const => self.lets == 0 && !self.is_local(at),
                _ => true,
            }
    }

    /// `node` after `unsafe` or `extern`
    fn continues_prefix(&self, at: usize) -> bool {
        let before = at.checked_sub(1).and_then(|i| self.token_at(i));
        matches!(before, Some(Token::Unsafe | Token::Extern))
    }

    /// Whether a `const` belongs to the declaration before it, whose body is still to come.
    fn is_local(&self, at: usize) -> bool {
        let head = self
            .chunks
            .last()
            .and_then(|c| self.token_at(c.range.start));
        let takes_locals = !self.complete && head.is_some_and(takes_locals);
        let mut next = self.lexemes[at..].iter().map(|lexeme| lexeme.token);
        takes_locals
            && next.find(|&t| t != Token::Const && (t == Token::Let || begins_declaration(t)))
                == Some(Token::Let)
    }

    /// `comand MoveToC`: two names in a row where a declaration could begin.
    fn begins_unknown(&self, at: usize) -> bool {
        use Token::{Dot, Ident, Path, Semi, Str, Tel};
        let before = at.checked_sub(1).and_then(|i| self.token_at(i));
        let free = self.complete || (self.lets, self.brackets) == (0, 0) && before == Some(Semi);
        free && matches!(before, None | Some(Semi | Tel | Dot | Str))
            && self.token_at(at) == Some(Ident)
            && matches!(self.token_at(at + 1), Some(Ident | Path | Str))
    }

    /// The word of a declaration that the name resembles.
    fn meant(&self, at: usize) -> Option<Token> {
        let Lexeme { start, end, .. } = self.lexemes[at];
        let name = &self.text[start as usize..end as usize];
        let words = || {
            KEYWORDS
                .iter()
                .filter(|w| begins_declaration(w.token) && w.is_in(self.mode))
        };
        let meant = suggest(name, words().map(|word| word.text))?;
        words()
            .find(|word| word.text == meant)
            .map(|word| word.token)
    }

    fn begins_line(&self, at: usize) -> bool {
        let start = self.lexemes[at].start as usize;
        start == 0 || self.text.as_bytes()[start - 1] == b'\n'
    }

    fn token_at(&self, at: usize) -> Option<Token> {
        self.lexemes.get(at).map(|lexeme| lexeme.token)
    }
}

/// Whether declarations begin with the word.
pub(crate) fn begins_declaration(token: Token) -> bool {
    use Token::{Const, Extern, Function, Include, Node, Type, Unsafe};
    match token.keyword() {
        Some(word) => {
            word.place == Place::Declaration
                || matches!(
                    token,
                    Const | Extern | Function | Include | Node | Type | Unsafe
                )
        }
        None => false,
    }
}

/// Whether what begins with the word may have local declarations before its `let`.
fn takes_locals(head: Token) -> bool {
    use Token::{Command, Fragment, Function, Node, Test, Unsafe};
    matches!(head, Command | Fragment | Function | Node | Test | Unsafe)
}
