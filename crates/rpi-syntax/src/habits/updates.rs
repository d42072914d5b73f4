//! Errors in functional updates of values: `(p with .x = 1; [2] = 3)`.

use super::operators::operand;
use super::{Habit, Mend, habit};
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::Fix;

/// Recognises an update without parentheses: `y = a with [1] = 7;`.
pub(super) fn no_parentheses(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    // On `with`, the parser has already reduced the value and no longer expects operators. That it expects `;`, `,` or
    // `)` shows that a value is complete.
    let ends = [Token::Semi, Token::Comma, Token::RParen];
    let is_value = ends.into_iter().any(|token| found.expects(token));
    if found.token(at) != Some(Token::With) || !is_value {
        return None;
    }
    let (start, end) = operand(found, at);
    let title = "add parentheses";
    // In a computed value, it is not clear to which operand the update applies.
    let is_part = |token| {
        matches!(
            token,
            Token::Dot | Token::Ident | Token::Int | Token::LBracket | Token::RBracket
        )
    };
    let fix = match found.lexemes[start..at]
        .iter()
        .all(|lexeme| is_part(lexeme.token))
    {
        true => Fix::sure(title),
        false => Fix::maybe(title),
    };
    let finding = habit("an update of a value is written in parentheses")
        .at(found.span_at(at), "`(a with [1] = x)`")
        .fix(
            fix.insert_before(found.span_at(start), "(")
                .insert_after(found.span_at(end - 1), ")"),
        );
    let mend = Mend::Tokens(vec![
        found.before_token(start, Token::LParen),
        found.before_token(end, Token::RParen),
    ]);
    Some(Habit { finding, mend })
}

/// Recognises an updated field without its dot: `(p with x = 1)`.
pub(super) fn no_dot(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let is_path = found.expects(Token::Dot) && found.expects(Token::LBracket);
    let is_name = found.token(at) == Some(Token::Ident);
    let begins = matches!(found.token_before(), Some(Token::With | Token::Semi));
    if !is_name || !is_path || !begins || found.expects(Token::Plus) {
        return None;
    }
    let finding = habit("an updated field is written with a dot")
        .at(found.span_at(at), format!("`.{}`", found.written(at)))
        .fix(Fix::sure("insert `.`").insert_before(found.span_at(at), "."));
    let mend = Mend::Tokens(vec![found.before_token(at, Token::Dot)]);
    Some(Habit { finding, mend })
}
