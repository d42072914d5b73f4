//! Errors in functional updates of values: `(p with .x = 1; [2] = 3)`.

use super::operators::operand_range;
use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::Fix;

/// Recognises an update without parentheses: `y = a with [1] = 7;`.
pub(super) fn update_without_parens(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    // On `with`, the parser has already reduced the value and no longer expects operators. That it expects `;`, `,` or
    // `)` shows that a value is complete.
    let ends = [Token::Semi, Token::Comma, Token::RParen];
    let is_value = ends.into_iter().any(|token| found.expects(token));
    if found.token_at(at) != Some(Token::With) || !is_value {
        return None;
    }
    let (start, end) = operand_range(found, at);
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
    let diagnostic = foreign_syntax("an update of a value is written in parentheses")
        .primary(
            found.token_span(at),
            "the update needs parentheses around it",
        )
        .fix(
            fix.insert_before(found.token_span(start), "(")
                .insert_after(found.token_span(end - 1), ")"),
        );
    let repair = Repair::ReplaceTokens(vec![
        found.insertion(start, Token::LParen),
        found.insertion(end, Token::RParen),
    ]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises an updated field without its dot: `(p with x = 1)`.
pub(super) fn field_without_dot(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_path = found.expects(Token::Dot) && found.expects(Token::LBracket);
    let is_name = found.token_at(at) == Some(Token::Ident);
    let begins = matches!(found.token_before(), Some(Token::With | Token::Semi));
    if !is_name || !is_path || !begins || found.expects(Token::Plus) {
        return None;
    }
    let diagnostic = foreign_syntax("an updated field is written with a dot")
        .primary(
            found.token_span(at),
            format!("expected `.{}`", found.source_text(at)),
        )
        .fix(Fix::sure("insert `.`").insert_before(found.token_span(at), "."));
    let repair = Repair::ReplaceTokens(vec![found.insertion(at, Token::Dot)]);
    Some(ForeignSyntax { diagnostic, repair })
}
