//! Comment marks of other languages: `//`, `#` and `%`.
//!
//! Each of them is also an operator in some language. So a mark after an operand begins a comment only if the rest of
//! the line is not an operand.

use super::{Lexeme, Lexer, LexicalErrorKind};
use crate::Dialect;
use crate::token::Token;
use crate::{lexical_errors, neighbours};
use logos::Logos;
use rpi_diag::{Diagnostic, Span};

/// Maximum number of tokens of a line that are inspected to distinguish a comment from an operand. Bounds the time for
/// long lines.
const MAX_TOKENS: usize = 40;

/// Names of predeclared flows and constants, which no program declares.
const PREDECLARED: &[&str] = &["dt", "first", "pi", "time"];

impl Lexer<'_> {
    /// Returns whether the mark `token` (`//`, `#` or `%`), which ends at byte offset `end`, begins a comment.
    ///
    /// `#` before `(` is an operator, `%` after a number means per cent, and `//` between operands is a division.
    pub(super) fn begins_comment(&self, token: Token, text: &str, end: u32) -> bool {
        let rest = &text[end as usize..];
        match token {
            Token::SlashComment => self.mode == Dialect::Lustre || !self.is_between_operands(rest),
            Token::Hash => !rest.trim_start_matches([' ', '\t']).starts_with('('),
            Token::Percent => self.mode == Dialect::Rpi && self.begins_statement(),
            _ => false,
        }
    }

    /// Reports a division written as `x // 2`, and adds the token `div` in place of `//`.
    pub(super) fn slash_division(&mut self, lexeme: Lexeme) {
        let span = self.span(lexeme);
        self.report(
            LexicalErrorKind::ForeignSyntax,
            lexical_errors::double_slash(span, self.text),
        );
        self.push(Token::Div, lexeme);
    }

    /// Creates the diagnostic of a comment with the marker of another language. `mark` is the length of the marker in
    /// bytes.
    pub(super) fn foreign_comment(&self, span: Span, mark: u32) -> Diagnostic {
        // After a value, the text may be a misspelt operand, and `#` begins directives of C. Then the fix is not sure.
        let behind_end = self.last_token() == Some(Token::End);
        let begins = behind_end || self.begins_statement();
        let is_slash = self.text[span.start as usize..].starts_with('/');
        lexical_errors::foreign_comment(span, mark, begins && is_slash)
    }

    fn last_token(&self) -> Option<Token> {
        self.output.lexemes.last().map(|lexeme| lexeme.token)
    }

    /// Returns whether a statement or the text begins after the tokens read so far.
    fn begins_statement(&self) -> bool {
        let before = self.last_token();
        matches!(before, None | Some(Token::Semi | Token::Let | Token::Tel))
    }

    /// Returns whether the tokens read so far end with an operand and an operand may begin with `rest`, the text after
    /// a mark.
    fn is_between_operands(&self, rest: &str) -> bool {
        self.last_token().is_some_and(neighbours::ends_value) && self.may_be_operand(rest)
    }

    /// Returns whether the first line of `rest` may be an operand: it has no unknown character and no two adjacent
    /// names or numbers.
    fn may_be_operand(&self, rest: &str) -> bool {
        let line = rest.lines().next().unwrap_or_default();
        let tokens: Vec<_> = Token::lexer(line).spanned().take(MAX_TOKENS).collect();
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
                called || PREDECLARED.contains(&name) || self.guessed_names.declares(name)
            }
            Token::Minus | Token::LBracket | Token::NumberWord | Token::IecLiteral => true,
            other => neighbours::begins_operand(*other) || other.keyword().is_some_and(|_| !in_row),
        };
        begins && !strange && !in_row
    }
}
