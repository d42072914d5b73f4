//! Brackets around types: splits `>>` where it closes two lists of types.

use crate::lexer::Lexeme;
use crate::token::Token;

/// Splits each `>>` that closes two nested lists of types, as in `any@<set<int>>`, into two tokens `>`.
pub(crate) fn split_closing(lexemes: &mut Vec<Lexeme>) {
    let mut open: Vec<Token> = Vec::new();
    let mut parted = Vec::new();
    for at in 0..lexemes.len() {
        match lexemes[at].token {
            Token::Lt if opens_type_list(lexemes, at, open.last()) => open.push(Token::Lt),
            Token::LStatic => open.push(Token::LStatic),
            Token::Gt | Token::RStatic if open.is_empty() => {}
            Token::Gt => {
                open.pop_if(|token| *token == Token::Lt);
            }
            Token::RStatic if open.pop() == Some(Token::Lt) => {
                if open.last() == Some(&Token::LStatic) && is_triple_closing(lexemes, at) {
                    shift_closing(lexemes, at);
                } else {
                    open.pop_if(|token| *token == Token::Lt);
                    parted.push(at);
                }
            }
            Token::Let | Token::Tel | Token::Eq => open.clear(),
            _ => {}
        }
    }
    for at in parted.into_iter().rev() {
        let whole = lexemes[at];
        let middle = whole.start + 1;
        lexemes[at] = Lexeme {
            token: Token::Gt,
            end: middle,
            ..whole
        };
        lexemes.insert(
            at + 1,
            Lexeme {
                token: Token::Gt,
                start: middle,
                ..whole
            },
        );
    }
}

/// Returns whether a `>` follows the token `at` directly, so that both form the `>>>` of `any<<type set<int>>>`.
fn is_triple_closing(lexemes: &[Lexeme], at: usize) -> bool {
    let next = lexemes.get(at + 1);
    next.is_some_and(|next| next.token == Token::Gt && next.start == lexemes[at].end)
}

/// Replaces the adjacent tokens `>>` and `>` at index `at` by `>` and `>>`, so that the `>` closes a list of types and
/// the `>>` a list of static arguments.
fn shift_closing(lexemes: &mut [Lexeme], at: usize) {
    let middle = lexemes[at].start + 1;
    (lexemes[at].token, lexemes[at].end) = (Token::Gt, middle);
    (lexemes[at + 1].token, lexemes[at + 1].start) = (Token::RStatic, middle);
}

/// Returns whether the `<` at index `at` opens a list of types instead of being a comparison: after `@`, after a name
/// in the place of a type, or inside such a list. `open` is the innermost open bracket.
fn opens_type_list(lexemes: &[Lexeme], at: usize, open: Option<&Token>) -> bool {
    use Token::{At, Colon, Comma, Gt, Ident, LStatic, Lt, Semi, Type};
    let token = |back: usize| at.checked_sub(back).map(|at| lexemes[at].token);
    match (token(1), token(2)) {
        (Some(At), _) | (Some(Ident), Some(Colon)) => true,
        (Some(Ident), Some(Lt | Comma | Semi | Gt)) => open == Some(&Lt),
        (Some(Ident), Some(Type)) => open == Some(&LStatic),
        _ => false,
    }
}
