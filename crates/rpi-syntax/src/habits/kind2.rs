//! Constructs of Kind 2 that a control core cannot execute and the grammar does not accept.
//!
//! A specific message keeps users from looking for a typing error. The type checker reports the constructs of Kind 2
//! that parse but cannot be executed.

use super::{Habit, Mend};
use crate::Mode;
use crate::ast::Ident;
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::{Code, Finding, Span};
use std::ops::Range;

/// Recognises set and map literals: `{1, 2}`, `map[]@<int, bool>`.
pub(super) fn container(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at.checked_sub(1)?;
    let is_map = at > 0 && found.written(at - 1) == "map";
    let (first, name) = match (found.token(at)?, found.token(at + 1)) {
        (Token::LBrace, _) if found.expects(Token::RBrace) => (at, "set"),
        (Token::LBracket, Some(Token::RBracket)) if is_map => (at - 1, "map"),
        _ => return None,
    };
    let last = found.structure.partner(at).unwrap_or(at);
    without_phrase(found, &format!("a {name}"), found.span_of(first..last + 1))
}

/// Recognises a reachability query: `check reachable x > 3`.
pub(super) fn reachable(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at.checked_sub(1)?;
    let follows_check = at > 0 && found.written(at - 1) == "check";
    if !follows_check || found.written(at) != "reachable" {
        return None;
    }
    without_phrase(found, "a reachability query", found.span_at(at))
}

/// Recognises a recursive function: `function rec f (n: int)`.
pub(super) fn recursive(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at.checked_sub(1)?;
    let follows = at > 0 && matches!(found.token(at - 1), Some(Token::Function | Token::Node));
    if !follows || found.written(at) != "rec" {
        return None;
    }
    let finding = refused(found, "a recursive function", found.span_at(at))?
        .help("compute across cycles: `n = 0 -> pre n + 1`; or over the elements of an array: `fold`, `red`");
    Some(Habit {
        finding,
        mend: Mend::Usual,
    })
}

/// Reports an unsupported construct at `span` and removes the phrase that contains it.
fn without_phrase(found: &Found<'_, '_>, construct: &str, span: Span) -> Option<Habit> {
    let finding = refused(found, construct, span)?;
    let phrase = found.structure.phrase(found.fault.at);
    let names = targets(found, phrase.clone());
    Some(Habit {
        finding,
        mend: Mend::Phrase(phrase, names),
    })
}

/// Returns the names before the `=` of an equation.
fn targets(found: &Found<'_, '_>, phrase: Range<usize>) -> Vec<Ident> {
    let is_head = |at: &usize| {
        matches!(
            found.token(*at),
            Some(Token::Ident | Token::Comma | Token::LParen | Token::RParen)
        )
    };
    let head: Vec<usize> = phrase.take_while(is_head).collect();
    let is_name = |at: &&usize| found.token(**at) == Some(Token::Ident);
    head.iter()
        .filter(is_name)
        .map(|at| found.ident(*at))
        .collect()
}

/// Creates the diagnostic of an unsupported construct; `None` unless the file is a Lustre file.
fn refused(found: &Found<'_, '_>, construct: &str, span: Span) -> Option<Finding> {
    let finding = Finding::new(
        Code::RPI0001,
        format!("{construct} of Kind 2 cannot be executed"),
    );
    (found.cx.mode == Mode::Lustre).then(|| finding.at(span, "not supported"))
}
