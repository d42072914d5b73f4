//! Enum types without `enum`, and modules named by a path or file name.

use super::ports::behind;
use super::{Habit, Mend, habit};
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::Fix;

/// Recognises an enum type without `enum`: `type Mode = { Off, On };`, `type Mode = Off | On;`.
pub(super) fn enum_without_word(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{Bar, Comma, Enum, Eq, Ident, LBrace, LParen, RBrace, RParen, Semi, Type};
    let fault = found.fault.at;
    let eq = (fault.saturating_sub(40)..fault)
        .rev()
        .take_while(|at| found.token(*at) != Some(Semi))
        .find(|at| found.token(*at) == Some(Eq))?;
    let before = eq.checked_sub(2).and_then(|at| found.token(at));
    let end = (eq..found.lexemes.len()).find(|at| found.token(*at) == Some(Semi))?;
    if found.token(0) != Some(Type) || !matches!(before, Some(Type | Semi)) || end < eq + 3 {
        return None;
    }
    let is_bracketed = matches!(found.token(eq + 1), Some(LBrace | LParen))
        && matches!(found.token(end - 1), Some(RBrace | RParen));
    let values = match is_bracketed {
        true => eq + 2..end - 1,
        false => eq + 1..end,
    };
    let is_value = |at: usize| match (at - values.start) % 2 {
        0 => found.token(at) == Some(Ident),
        _ => matches!(found.token(at), Some(Bar | Comma)),
    };
    if values.len() % 2 == 0 || !values.clone().all(is_value) {
        return None;
    }
    let names: Vec<&str> = values
        .clone()
        .step_by(2)
        .map(|at| found.written(at))
        .collect();
    let meant = format!("enum {{ {} }}", names.join(", "));
    let place = found.span_of(eq + 1..end);
    let finding = habit("an enumeration type is written with `enum`")
        .at(place, "expected a type")
        .fix(Fix::sure(format!("write `{meant}`")).replace(place, meant));
    let mut tokens = found.instead(eq + 1, &[Enum, LBrace]).1;
    for at in values {
        match found.token(at) {
            Some(Ident) => tokens.push(found.lexemes[at]),
            _ => tokens.extend(found.instead(at, &[Comma]).1),
        }
    }
    tokens.extend(found.instead(end - 1, &[RBrace]).1);
    Some(Habit {
        finding,
        mend: Mend::Tokens(vec![(eq + 1..end, behind(&tokens))]),
    })
}

/// Recognises modules named by a path or file: `use std::math;`, `use "motion";`, `include <motion>;`.
pub(super) fn module(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let before = found.token_before()?;
    let written = found.written(at);
    let is_name = matches!(found.token(at), Some(Token::Path | Token::Str | Token::Lt));
    if !matches!(before, Token::Use | Token::Include) || !is_name {
        return None;
    }
    let last = written.rsplit("::").next().unwrap_or(written);
    let last = last.trim_matches('"').trim_end_matches(".rpi");
    let finding = habit("a module name is a single identifier")
        .at(found.span_at(at), "not a module name")
        .help("`use motion;` imports `motion.rpi` from this folder or the standard library; `include \"file.lus\"` includes a file");
    let is_word = !last.is_empty() && last.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let finding = match before == Token::Use && is_word {
        true => finding
            .fix(Fix::maybe(format!("write `{last}`")).replace(found.span_at(at), last.to_owned())),
        false => finding,
    };
    Some(Habit {
        finding,
        mend: Mend::Item,
    })
}
