//! Habits from other state machines: transitions as SCADE and its kin write them.

use super::bodies::behind;
use super::operators::own_if;
use super::{Habit, Mend, habit};
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::Fix;

/// `until if c then S`
pub(super) fn conditional(found: &Found<'_, '_>) -> Option<Habit> {
    let own = own_if(found)?;
    let first = matches!(
        found.token(own.checked_sub(1)?),
        Some(Token::Until | Token::Unless | Token::Bar)
    );
    if !first || !found.expects(Token::Else) || !is_transition(found) {
        return None;
    }
    let with_gap = found
        .cx
        .span(found.lexemes[own].start, found.lexemes[own + 1].start);
    let finding = habit("the condition of a transition needs no `if`")
        .at(found.span_at(own), "a transition always has one")
        .fix(Fix::sure("delete `if`").replace(with_gap, ""));
    let mend = Mend::Tokens(vec![(own..own + 1, Vec::new())]);
    Some(Habit { finding, mend })
}

/// `until c restart S`, `until c resume S`
pub(super) fn entry(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let (word, token) = match found.written(at) {
        "restart" | "goto" => ("then", Token::Then),
        "resume" => ("continue", Token::Continue),
        _ => return None,
    };
    if !found.expects(Token::Then) || !is_transition(found) {
        return None;
    }
    let finding =
        habit("the next state follows `then`, or `continue` if it goes on where it was left")
            .at(found.span_at(at), "a word of another language")
            .fix(Fix::sure(format!("write `{word}`")).replace(found.span_at(at), word));
    let mend = Mend::Tokens(vec![found.instead(at, &[token])]);
    Some(Habit { finding, mend })
}

/// `state S let ... tel unless c then T;`
pub(super) fn late_unless(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.token(at) != Some(Token::Unless) || !found.expects(Token::Until) {
        return None;
    }
    let name = 1 + state_before(found, at)?;
    let end = found.structure.phrase(at).end.max(at + 1);
    let last = end.min(found.lexemes.len() - 1);
    let old = found
        .cx
        .span(found.lexemes[at - 1].end, found.lexemes[last].end);
    let text = found.text(at..end).to_owned();
    let fix = Fix::sure("put it before the body")
        .replace(behind(found.span_at(name)), format!(" {text};"))
        .replace(old, "");
    let finding = habit("`unless` stands before the body of its state")
        .at(
            found.span_at(at),
            "a strong transition is decided before the body is computed",
        )
        .also(found.span_at(name), "it belongs behind this name")
        .fix(fix);
    let mend = Mend::Phrase(at..end, Vec::new());
    Some(Habit { finding, mend })
}

/// Whether the fault is in a transition.
fn is_transition(found: &Found<'_, '_>) -> bool {
    let at = found.fault.at;
    let phrase = found.structure.phrase(at.saturating_sub(1));
    let mut before = (phrase.start.min(at)..at).map(|at| found.token(at));
    before.any(|token| matches!(token, Some(Token::Until | Token::Unless)))
}

/// The `state` whose body ends before a token.
fn state_before(found: &Found<'_, '_>, at: usize) -> Option<usize> {
    let mut at = at;
    loop {
        at = at.checked_sub(1)?;
        match found.token(at)? {
            Token::State => return Some(at),
            Token::Tel => at = found.structure.partner(at)?,
            _ => {}
        }
    }
}
