//! Operators of other languages: each is reported and replaced by the equivalent operator of RPI.

use super::{Lexeme, Lexer, LexicalErrorKind};
use crate::foreign::AssignContext;
use crate::token::Token;
use crate::{Dialect, foreign};
use rpi_diag::Span;

/// Lazy implication of Kind 2: its right side is evaluated only if the left side holds.
const LAZY_IMPLICATION: &str = "==>";

/// Operator of Kind 2 between an index and its new value in an update: `a[0 := x]`.
const ASSIGN: &str = ":=";

/// Maximum number of tokens that are searched backwards for an open bracket. Bounds the time for long lists.
const MAX_LOOKBEHIND: usize = 200;

/// Reads `&&`, `||` and `!` as Boolean operators in statements that contain comparisons of C, such as `==`, and reports
/// them.
// In Lustre mode, `&&`, `||` and `!` are bit operators of Kind 2. Next to `==`, the author most likely wrote C.
pub(super) fn convert_c_operators(lexer: &mut Lexer<'_>) {
    use Token::{BitAnd, BitNot, BitOr, Let, Semi, Tel};
    let is_c_comparison = |lexeme: &Lexeme, text: &str| {
        let written = &text[lexeme.start as usize..lexeme.end as usize];
        matches!(written, "==" | "===" | "!=" | "!==")
    };
    let text = lexer.text;
    if !lexer
        .output
        .lexemes
        .iter()
        .any(|lexeme| is_c_comparison(lexeme, text))
    {
        return;
    }
    let is_end = |lexeme: &Lexeme| matches!(lexeme.token, Let | Semi | Tel);
    let is_bits = |lexeme: &&mut Lexeme| matches!(lexeme.token, BitAnd | BitNot | BitOr);
    let mut signs = Vec::new();
    for statement in lexer.output.lexemes.split_mut(is_end) {
        if statement.iter().any(|lexeme| is_c_comparison(lexeme, text)) {
            for lexeme in statement.iter_mut().filter(is_bits) {
                let written = &text[lexeme.start as usize..lexeme.end as usize];
                let Some(sign) = foreign::find_operator(written) else {
                    continue;
                };
                let span = Span::new(lexer.file, lexeme.start, lexeme.end);
                signs.push(foreign::operator_diagnostic(span, text, sign));
                lexeme.token = sign.token;
            }
        }
    }
    for diagnostic in signs {
        lexer.report(LexicalErrorKind::ForeignSyntax, diagnostic);
    }
}

impl Lexer<'_> {
    /// Splits a two-character token such as `++`, which is no operator in RPI files, into two tokens `sign`.
    pub(super) fn split_operator(&mut self, sign: Token, lexeme: Lexeme) {
        let middle = lexeme.start + 1;
        self.push(
            sign,
            Lexeme {
                end: middle,
                ..lexeme
            },
        );
        self.push(
            sign,
            Lexeme {
                start: middle,
                ..lexeme
            },
        );
    }

    /// Reports an operator of another language, such as `==`, and adds its RPI equivalent as a token.
    pub(super) fn foreign_operator(&mut self, lexeme: Lexeme) {
        let written = self.slice(lexeme);
        if self.mode == Dialect::Lustre && written == LAZY_IMPLICATION {
            return self.push(Token::Implies, lexeme);
        }
        if written == ASSIGN {
            return self.assign_operator(lexeme);
        }
        let Some(sign) = foreign::find_operator(written) else {
            return self.unknown_chars(lexeme.start, lexeme.end);
        };
        let diagnostic = foreign::operator_diagnostic(self.span(lexeme), self.text, sign);
        self.report(LexicalErrorKind::ForeignSyntax, diagnostic);
        self.push(sign.token, lexeme);
    }

    /// Adds the token for `:=`, an operator of Kind 2 within brackets in Lustre files; reports an error elsewhere.
    fn assign_operator(&mut self, lexeme: Lexeme) {
        if self.mode == Dialect::Lustre && self.is_in_brackets() {
            return self.push(Token::Becomes, lexeme);
        }
        let context = self.assign_context();
        let (diagnostic, token) = foreign::assign_diagnostic(self.span(lexeme), self.text, context);
        let kind = match context {
            AssignContext::Argument => LexicalErrorKind::NamedArgument,
            AssignContext::Definition | AssignContext::Comparison | AssignContext::Other => {
                LexicalErrorKind::ForeignSyntax
            }
        };
        self.report(kind, diagnostic);
        self.push(token, lexeme);
    }

    /// Returns the construct in which a `:=` after the tokens read so far occurs.
    fn assign_context(&self) -> AssignContext {
        use Token::{And, Assert, If, Not, Or, Unless, Until, When};
        use Token::{
            BoolType, Colon, Comma, Dot, Ident, Int, IntType, LBracket, RBracket, RealType,
        };
        use Token::{Const, LParen, Let, Path, RParen, RStatic, Semi, Tel, Var};
        let tokens = self.output.lexemes.iter().rev().take(MAX_LOOKBEHIND);
        let mut tokens = tokens.map(|lexeme| lexeme.token).peekable();
        let is_named =
            tokens.next_if_eq(&Ident).is_some() && matches!(tokens.peek(), Some(LParen | Comma));
        let mut open = 0;
        while let Some(token) = tokens.next() {
            match token {
                RParen => open += 1,
                LParen if open > 0 => open -= 1,
                LParen if is_named && matches!(tokens.peek(), Some(Ident | Path | RStatic)) => {
                    return AssignContext::Argument;
                }
                Const | Let | Semi | Tel | Var => return AssignContext::Definition,
                BoolType | Colon | Comma | Dot | Ident | Int | IntType | LBracket | Path
                | RBracket | RealType | LParen => {}
                _ if is_named => {}
                And | Assert | If | Not | Or | Unless | Until | When => {
                    return AssignContext::Comparison;
                }
                _ => return AssignContext::Other,
            }
        }
        AssignContext::Other
    }

    /// Returns whether a `[` is open after the tokens read so far, or an update such as `a[0 := x; 1` has begun.
    fn is_in_brackets(&self) -> bool {
        let mut closed = 0u32;
        let before = self.output.lexemes.iter().rev().take(MAX_LOOKBEHIND);
        for lexeme in before {
            match lexeme.token {
                Token::RBracket => closed += 1,
                Token::LBracket | Token::Becomes if closed == 0 => return true,
                Token::LBracket => closed -= 1,
                Token::Let | Token::Tel => return false,
                _ => {}
            }
        }
        false
    }
}
