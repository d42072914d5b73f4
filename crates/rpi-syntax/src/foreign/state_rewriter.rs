//! Rewrites an automaton in the syntax of another language.

use crate::foreign::states;
use crate::lexer::Lexeme;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::Fix;
use std::ops::Range;

/// Replacement of a range of token indices by other tokens.
pub(super) struct Edit {
    range: Range<usize>,
    tokens: Vec<Token>,
}

impl Edit {
    pub(crate) fn token_edit(&self, found: &ErrorContext<'_, '_>) -> (Range<usize>, Vec<Lexeme>) {
        let mut lexemes = Vec::new();
        for token in &self.tokens {
            lexemes.extend(found.insertion(self.range.start, *token).1);
        }
        (self.range.clone(), lexemes)
    }

    pub(crate) fn add_to_fix(&self, found: &ErrorContext<'_, '_>, fix: Fix) -> Fix {
        let words: Vec<&str> = self
            .tokens
            .iter()
            .filter_map(|token| token.spelling())
            .collect();
        let text = words.join(" ").replace(" ;", ";");
        if !self.range.is_empty() {
            return fix.replace(found.range_span(self.range.clone()), text);
        }
        let behind = found.token_span(self.range.start.saturating_sub(1));
        match text.starts_with(';') {
            true => fix.insert_after(behind, text),
            false => fix.insert_after(behind, format!(" {text}")),
        }
    }
}

/// Walker over the states of an automaton in foreign syntax. It collects the edits that turn the automaton into RPI
/// syntax. `at` is the index of the current token.
pub(crate) struct Rewriter<'r, 'f, 't> {
    pub(crate) found: &'r ErrorContext<'f, 't>,
    pub(crate) at: usize,
    pub(crate) edits: Vec<Edit>,
}

impl Rewriter<'_, '_, '_> {
    pub(crate) fn automaton(mut self) -> Option<Vec<Edit>> {
        let mut first = true;
        let is_braced = self.token() == Some(Token::LBrace);
        if is_braced {
            self.replace(1, &[]);
        }
        loop {
            if self.token() == Some(Token::Bar) {
                self.replace(1, &[]);
            }
            if self.is_end() {
                break;
            }
            self.header(first)?;
            self.body();
            self.transitions();
            first = false;
        }
        match self.token() {
            Some(Token::End) => {}
            Some(Token::RBrace) if is_braced => self.replace(1, &[Token::End]),
            _ => self.insert(&[Token::End]),
        }
        Some(self.edits)
    }

    fn is_end(&self) -> bool {
        matches!(
            self.token(),
            None | Some(Token::End | Token::RBrace | Token::Tel)
        )
    }

    /// Walks over the header of a state, `initial state A`, and inserts missing keywords. `first` is true for the first
    /// state. Returns `None` without a state name.
    fn header(&mut self, first: bool) -> Option<()> {
        let is_initial = self.token() == Some(Token::Initial);
        self.at += usize::from(is_initial);
        let has_word = self.token() == Some(Token::State);
        let words: &[Token] = match (first && !is_initial && !self.any_initial(), has_word) {
            (true, true) => &[Token::Initial],
            (true, false) => &[Token::Initial, Token::State],
            (false, true) => &[],
            (false, false) => &[Token::State],
        };
        self.insert(words);
        self.at += usize::from(has_word);
        let is_name = self.token() == Some(Token::Ident);
        self.at += 1;
        is_name.then_some(())
    }

    /// Returns whether a state after the current token is marked `initial`.
    fn any_initial(&self) -> bool {
        let after = self.at..self.found.lexemes.len();
        let mut tokens = after.map(|at| self.found.token_at(at));
        tokens.any(|token| token == Some(Token::Initial))
    }

    fn body(&mut self) {
        if self.token() == Some(Token::Unless) {
            self.transition();
        }
        if self.token() == Some(Token::Let) {
            let close = self.found.structure.partner(self.at);
            self.at = close.map_or(self.found.lexemes.len(), |close| close + 1);
            return;
        }
        let Some(start) = states::body_start(self.found, self.at) else {
            return;
        };
        self.replace(start - self.at, &[Token::Let]);
        while !self.ends_body() {
            self.at += 1;
        }
        self.close_body(start);
    }

    /// Ends the body that begins at token `start`: writes `tel` at the current token, in place of a closing word of
    /// another language if there is one.
    fn close_body(&mut self, start: usize) {
        let lacks_semi = self.at > start && self.before() != Some(Token::Semi);
        let tokens: &[Token] = if lacks_semi {
            &[Token::Semi, Token::Tel]
        } else {
            &[Token::Tel]
        };
        let closes = self.token() == Some(Token::RBrace)
            || states::is_any_of(self.found, self.at, &["done"]);
        match closes {
            true => self.replace(1, tokens),
            false => self.insert(tokens),
        }
    }

    fn ends_body(&self) -> bool {
        use Token::{Bar, End, Initial, RBrace, State, Tel, Unless, Until};
        let ends = matches!(
            self.token(),
            None | Some(Bar | End | Initial | RBrace | State | Tel | Unless | Until)
        );
        ends || states::is_any_of(self.found, self.at, &["done"]) || self.begins_bare_state()
    }

    /// Returns whether a state without the keyword `state` begins at the current token: `B -> do ...`.
    fn begins_bare_state(&self) -> bool {
        self.token() == Some(Token::Ident)
            && self.found.token_at(self.at + 1) == Some(Token::Arrow)
            && states::body_start(self.found, self.at + 1) == Some(self.at + 3)
    }

    fn transitions(&mut self) {
        while matches!(self.token(), Some(Token::Until | Token::Unless)) {
            self.transition();
        }
    }

    fn transition(&mut self) {
        use Token::{End, Initial, Let, Semi, State, Tel, Unless, Until};
        self.at += 1;
        loop {
            match self.token() {
                Some(Semi) => {
                    self.at += 1;
                    return;
                }
                None | Some(End | Initial | Let | Token::RBrace | State | Tel | Unless | Until) => {
                    break;
                }
                Some(_)
                    if self.begins_bare_state()
                        || states::body_start(self.found, self.at) == Some(self.at + 1)
                            && self.token() != Some(Token::Arrow) =>
                {
                    break;
                }
                Some(_) => self.at += 1,
            }
        }
        self.insert(&[Semi]);
    }

    fn token(&self) -> Option<Token> {
        self.found.token_at(self.at)
    }

    fn before(&self) -> Option<Token> {
        self.found.token_at(self.at - 1)
    }

    fn insert(&mut self, tokens: &[Token]) {
        if !tokens.is_empty() {
            self.edit(0, tokens);
        }
    }

    fn replace(&mut self, count: usize, tokens: &[Token]) {
        self.edit(count, tokens);
        self.at += count;
    }

    /// Records the replacement of the next `count` tokens by `tokens`. Insertions at the same position become one edit.
    fn edit(&mut self, count: usize, tokens: &[Token]) {
        let range = self.at..self.at + count;
        match self.edits.last_mut() {
            Some(last) if last.range.end == range.start && last.range.is_empty() => {
                last.range.end = range.end;
                last.tokens.extend_from_slice(tokens);
            }
            _ => self.edits.push(Edit {
                range,
                tokens: tokens.to_vec(),
            }),
        }
    }
}
