//! Lexing of numbers: checks, and conversion of literals of other languages.

use super::{Lexeme, Lexer, LexicalErrorKind};
use crate::Dialect;
use crate::foreign_literal::{self, ForeignLiteral, LiteralReplacement};
use crate::lexical_errors::{self, SuffixKind};
use crate::token::{KeywordContext, Token};
use logos::Logos;
use rpi_diag::Code;

impl Lexer<'_> {
    /// Adds the token of a number. Reports a number that is too large.
    pub(super) fn number(&mut self, lexeme: Lexeme) {
        let is_machine = self.is_machine_int_operand();
        let diagnostic =
            lexical_errors::check_number(self.span(lexeme), self.slice(lexeme), is_machine);
        if let Some(diagnostic) = diagnostic {
            self.report(LexicalErrorKind::Other, diagnostic);
        }
        self.push(lexeme.token, lexeme);
    }

    /// Splits a token such as `0..` into an integer and the token `..`, and adds both.
    pub(super) fn int_dot_dot(&mut self, lexeme: Lexeme) {
        let middle = lexeme.end - 2;
        self.number(Lexeme {
            token: Token::Int,
            end: middle,
            ..lexeme
        });
        let dots = Lexeme {
            start: middle,
            ..lexeme
        };
        self.push(Token::DotDot, dots);
    }

    /// Returns the keyword that is spelt `text`; `None` if there is none, or if it cannot follow a number.
    fn keyword_after_number(&self, text: &str) -> Option<Token> {
        let token = Token::from_spelling(text)?;
        let word = token.keyword().filter(|word| word.is_in(self.mode))?;
        let is_word =
            word.is_reserved_in(self.mode) || word.context == KeywordContext::AfterOperand;
        is_word.then_some(token)
    }

    /// Reports a number that is directly followed by a word, such as `250mm/s`, and adds the tokens of the number with
    /// its unit, factor or keyword.
    pub(super) fn number_with_suffix(&mut self, lexeme: Lexeme) {
        let text = self.slice(lexeme);
        let digits = foreign_literal::number_len(text);
        let is_foreign = !self.guessed_names.declares(&text[digits..]);
        if let Some(mut numeral) = foreign_literal::convert_number(text).filter(|_| is_foreign) {
            // `5z` may be a misspelling of a flow `z5`.
            let (number, suffix) = text.split_at(digits);
            numeral.is_sure &= !self.guessed_names.declares(&format!("{suffix}{number}"));
            return self.foreign_literal(lexeme, LexicalErrorKind::Other, numeral);
        }
        let word = self.keyword_after_number(&text[digits..]);
        let behind = match word {
            Some(_) => SuffixKind::Keyword,
            None if self.guessed_names.declares(&text[digits..]) => SuffixKind::Name,
            None => SuffixKind::Unit,
        };
        let diagnostic = lexical_errors::invalid_suffix(self.span(lexeme), text, digits, behind);
        self.report(LexicalErrorKind::Other, diagnostic);
        let end = lexeme.start + digits as u32;
        let token = match text[..digits].contains(['.', 'e', 'E']) {
            true => Token::Real,
            false => Token::Int,
        };
        self.push(token, Lexeme { end, ..lexeme });
        match word {
            Some(word) => self.push(
                word,
                Lexeme {
                    start: end,
                    ..lexeme
                },
            ),
            None if behind == SuffixKind::Name => self.push_factor(lexeme, end),
            None => self.push_unit(&text[digits..], end),
        }
    }

    /// Adds the tokens of a product for a name directly after a number: an inserted `*`, and the name. The name begins
    /// at byte offset `start`.
    fn push_factor(&mut self, lexeme: Lexeme, start: u32) {
        let star = Lexeme {
            token: Token::Star,
            start,
            end: start,
        };
        self.output.lexemes.push(star);
        self.push(Token::Ident, Lexeme { start, ..lexeme });
    }

    /// Adds the tokens of a unit without brackets, with inserted brackets. The unit begins at byte offset `start`.
    fn push_unit(&mut self, text: &str, start: u32) {
        let at = |offset: usize| start + offset as u32;
        let bracket = |token, place| Lexeme {
            token,
            start: place,
            end: place,
        };
        self.output.lexemes.push(bracket(Token::LBracket, start));
        for (token, range) in Token::lexer(text).spanned() {
            let (start, end) = (at(range.start), at(range.end));
            let token = token.unwrap_or(Token::Broken);
            self.output.lexemes.push(Lexeme { token, start, end });
        }
        self.output
            .lexemes
            .push(bracket(Token::RBracket, at(text.len())));
    }

    /// Reports a literal of IEC 61131-3, such as `T#500ms`, and adds its RPI equivalent as tokens.
    pub(super) fn iec_literal(&mut self, lexeme: Lexeme) {
        let numeral = foreign_literal::convert_iec(self.slice(lexeme));
        self.foreign_literal(lexeme, LexicalErrorKind::ForeignSyntax, numeral);
    }

    /// Reports a literal of another language and adds its replacement as tokens.
    fn foreign_literal(&mut self, lexeme: Lexeme, kind: LexicalErrorKind, numeral: ForeignLiteral) {
        let code = match kind {
            LexicalErrorKind::ForeignSyntax => Code::RPI0016,
            _ => Code::RPI0007,
        };
        let (span, text) = (self.span(lexeme), self.slice(lexeme));
        let diagnostic = lexical_errors::foreign_literal(span, text, code, &numeral);
        self.report(kind, diagnostic);
        let place = (lexeme.start, lexeme.end);
        match numeral.replacement {
            LiteralReplacement::Bool(true) => self.push(Token::True, lexeme),
            LiteralReplacement::Bool(false) => self.push(Token::False, lexeme),
            LiteralReplacement::Name(name) => {
                self.output.replaced_text.insert(place, name);
                self.push(Token::Ident, lexeme);
            }
            LiteralReplacement::Number(number, unit) => {
                let is_real = !number.starts_with("0x") && number.contains(['.', 'e', 'E']);
                self.output.replaced_text.insert(place, number);
                let token = if is_real { Token::Real } else { Token::Int };
                self.push(token, lexeme);
                if let Some(unit) = unit {
                    self.push_replaced_unit(unit, lexeme.end);
                }
            }
        }
    }

    /// Adds the tokens of a unit in brackets that does not occur in the text. All tokens are empty and lie at byte
    /// offset `at`.
    fn push_replaced_unit(&mut self, unit: &str, at: u32) {
        self.output.replaced_text.insert((at, at), unit.to_owned());
        for token in [Token::LBracket, Token::Ident, Token::RBracket] {
            let (start, end) = (at, at);
            self.output.lexemes.push(Lexeme { token, start, end });
        }
    }

    /// Returns whether the tokens read so far end with a conversion of the next number to a 64-bit machine integer:
    /// `(uint64 18446744073709551615)`.
    fn is_machine_int_operand(&self) -> bool {
        use Token::{Gt, Int64, LParen, UInt64};
        let mut before = self
            .output
            .lexemes
            .iter()
            .rev()
            .take(4)
            .map(|lexeme| lexeme.token);
        let before = before.find(|token| *token != LParen);
        self.mode == Dialect::Lustre && matches!(before, Some(UInt64 | Int64 | Gt))
    }
}
