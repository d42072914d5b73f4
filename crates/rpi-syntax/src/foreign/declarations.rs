//! Enum types without `enum`, and modules named by a path or file name.

use super::type_first::in_text_order;
use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::Fix;

/// Recognises an enum type without `enum`: `type Mode = { Off, On };`, `type Mode = Off | On;`.
pub(super) fn enum_without_keyword(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Bar, Comma, Enum, Eq, Ident, LBrace, LParen, RBrace, RParen, Semi, Type};
    let fault = found.error.index;
    let eq = (fault.saturating_sub(40)..fault)
        .rev()
        .take_while(|at| found.token_at(*at) != Some(Semi))
        .find(|at| found.token_at(*at) == Some(Eq))?;
    let before = eq.checked_sub(2).and_then(|at| found.token_at(at));
    let end = (eq..found.lexemes.len()).find(|at| found.token_at(*at) == Some(Semi))?;
    if found.token_at(0) != Some(Type) || !matches!(before, Some(Type | Semi)) || end < eq + 3 {
        return None;
    }
    let is_bracketed = matches!(found.token_at(eq + 1), Some(LBrace | LParen))
        && matches!(found.token_at(end - 1), Some(RBrace | RParen));
    let values = match is_bracketed {
        true => eq + 2..end - 1,
        false => eq + 1..end,
    };
    let is_value = |at: usize| match (at - values.start) % 2 {
        0 => found.token_at(at) == Some(Ident),
        _ => matches!(found.token_at(at), Some(Bar | Comma)),
    };
    if values.len() % 2 == 0 || !values.clone().all(is_value) {
        return None;
    }
    let names: Vec<&str> = values
        .clone()
        .step_by(2)
        .map(|at| found.source_text(at))
        .collect();
    let meant = format!("enum {{ {} }}", names.join(", "));
    let place = found.range_span(eq + 1..end);
    let diagnostic = foreign_syntax("an enumeration type is written with `enum`")
        .primary(place, "expected a type")
        .fix(Fix::sure(format!("write `{meant}`")).replace(place, meant));
    let mut tokens = found.replacement(eq + 1, &[Enum, LBrace]).1;
    for at in values {
        match found.token_at(at) {
            Some(Ident) => tokens.push(found.lexemes[at]),
            _ => tokens.extend(found.replacement(at, &[Comma]).1),
        }
    }
    tokens.extend(found.replacement(end - 1, &[RBrace]).1);
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::ReplaceTokens(vec![(eq + 1..end, in_text_order(&tokens))]),
    })
}

/// Recognises a module that is named by a path or file: `use std::math;`, `use "motion";`, `include <motion>;`.
pub(super) fn module_by_path(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let before = found.token_before()?;
    let written = found.source_text(at);
    let is_name = matches!(
        found.token_at(at),
        Some(Token::Path | Token::Str | Token::Lt)
    );
    if !matches!(before, Token::Use | Token::Include) || !is_name {
        return None;
    }
    let last = written.rsplit("::").next().unwrap_or(written);
    let last = last.trim_matches('"').trim_end_matches(".rpi");
    let diagnostic = foreign_syntax("a module name is a single identifier")
        .primary(found.token_span(at), "not a module name")
        .help("`use motion;` imports `motion.rpi` from this folder or the standard library; `include \"file.lus\"` includes a file");
    let is_word = !last.is_empty() && last.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let diagnostic = match before == Token::Use && is_word {
        true => diagnostic.fix(
            Fix::maybe(format!("write `{last}`")).replace(found.token_span(at), last.to_owned()),
        ),
        false => diagnostic,
    };
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveItem,
    })
}
