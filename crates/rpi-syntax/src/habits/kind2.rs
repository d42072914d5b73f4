//! What Kind 2 writes and a control core can not run: named, so that nobody looks for a slip of the pen.
//!
//! What is read and only not run is told by the type checker, with its types; here is what the grammar does not know.

use super::{Habit, Mend};
use crate::Mode;
use crate::ast::Ident;
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::{Code, Finding, Span};
use std::ops::Range;

/// `{1, 2}`, `map[]@<int, bool>`
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

/// `check reachable x > 3`
pub(super) fn reachable(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at.checked_sub(1)?;
    let follows_check = at > 0 && found.written(at - 1) == "check";
    if !follows_check || found.written(at) != "reachable" {
        return None;
    }
    without_phrase(found, "a question of reachability", found.span_at(at))
}

/// `function rec f (n: int)`
pub(super) fn recursive(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at.checked_sub(1)?;
    let follows = at > 0 && matches!(found.token(at - 1), Some(Token::Function | Token::Node));
    if !follows || found.written(at) != "rec" {
        return None;
    }
    let finding = refused(found, "a recursive function", found.span_at(at))?
        .help("go on from cycle to cycle: `n = 0 -> pre n + 1`; or over the elements of an array: `fold`, `red`");
    Some(Habit {
        finding,
        mend: Mend::Usual,
    })
}

/// Leaves out the phrase that needs a construct.
fn without_phrase(found: &Found<'_, '_>, construct: &str, span: Span) -> Option<Habit> {
    let finding = refused(found, construct, span)?;
    let phrase = found.structure.phrase(found.fault.at);
    let names = targets(found, phrase.clone());
    Some(Habit {
        finding,
        mend: Mend::Phrase(phrase, names),
    })
}

/// The names before the `=` of an equation.
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

fn refused(found: &Found<'_, '_>, construct: &str, span: Span) -> Option<Finding> {
    let finding = Finding::new(
        Code::RPI0001,
        format!("{construct} of Kind 2 can not be run here"),
    );
    (found.cx.mode == Mode::Lustre).then(|| finding.at(span, "not read"))
}
