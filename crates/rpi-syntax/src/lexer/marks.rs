//! Marks by which other languages begin comments: `//`, `#` and `%`.
//!
//! Each of them is an operator elsewhere, too. So a mark behind an operand is only surely a comment if what follows on its line is no
//! operand.

use super::{Lexeme, Lexer};
use crate::Mode;
use crate::token::Token;
use crate::{lexical, words};
use logos::Logos;
use rpi_diag::{Finding, Span};

/// How many tokens of a line are looked at.
const NEAR: usize = 40;

/// Values that no text declares.
const PREDECLARED: &[&str] = &["dt", "first", "pi", "time"];

impl Lexer<'_> {
    /// Whether a comment begins at a mark: `#` is an operator before `(`, `%` stands behind a number, and `//` divides
    /// where it stands between operands.
    pub(super) fn begins_comment(&self, token: Token, text: &str, end: u32) -> bool {
        let rest = &text[end as usize..];
        match token {
            Token::SlashComment => self.mode == Mode::Lustre || !self.is_between_operands(rest),
            Token::Hash => !rest.trim_start_matches([' ', '\t']).starts_with('('),
            Token::Percent => self.mode == Mode::Rpi && self.begins_phrase(),
            _ => false,
        }
    }

    /// `x // 2`: reported, and read as the quotient.
    pub(super) fn quotient(&mut self, lexeme: Lexeme) {
        let span = self.span(lexeme);
        self.out
            .findings
            .push(lexical::double_slash(span, self.text));
        self.push(Token::Div, lexeme);
    }

    /// A comment that another mark begins, of so many bytes.
    pub(super) fn foreign_comment(&self, span: Span, mark: u32) -> Finding {
        // Behind a value the text may be an operand that is misspelt, and `#` begins directives.
        let behind_end = self.last_token() == Some(Token::End);
        let begins = behind_end || self.begins_phrase();
        let is_slash = self.text[span.start as usize..].starts_with('/');
        lexical::foreign_comment(span, mark, begins && is_slash)
    }

    fn last_token(&self) -> Option<Token> {
        self.out.lexemes.last().map(|lexeme| lexeme.token)
    }

    /// Whether a phrase, or the text, begins here.
    fn begins_phrase(&self) -> bool {
        let before = self.last_token();
        matches!(before, None | Some(Token::Semi | Token::Let | Token::Tel))
    }

    /// Whether an operand ends before a mark, and the text behind it could be another one with what follows it.
    fn is_between_operands(&self, rest: &str) -> bool {
        self.last_token().is_some_and(words::ends_value) && self.goes_on(rest)
    }

    /// Whether the rest of a line could go on with an operand: nothing strange is in it, and no two names or numbers in a row.
    fn goes_on(&self, rest: &str) -> bool {
        let line = rest.lines().next().unwrap_or_default();
        let tokens: Vec<_> = Token::lexer(line).spanned().take(NEAR).collect();
        let is_plain = |token: &Result<Token, ()>| {
            matches!(
                token,
                Ok(Token::Ident | Token::Int | Token::Path | Token::Real)
            )
        };
        let strange = tokens.iter().any(|(token, _)| token.is_err());
        let in_row = tokens
            .windows(2)
            .any(|pair| pair.iter().all(|(token, _)| is_plain(token)));
        let Some((Ok(first), range)) = tokens.first() else {
            return false;
        };
        let called = matches!(tokens.get(1), Some((Ok(Token::LParen | Token::LStatic), _)));
        let begins = match first {
            Token::Ident => {
                let name = &line[range.clone()];
                called || PREDECLARED.contains(&name) || self.seeming.declares(name)
            }
            Token::Minus | Token::LBracket | Token::NumberWord | Token::IecLiteral => true,
            other => words::begins_operand(*other) || other.keyword().is_some_and(|_| !in_row),
        };
        begins && !strange && !in_row
    }
}
