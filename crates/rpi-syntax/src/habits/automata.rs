//! Habits from other state machines: transitions as SCADE and its kin write them.

use super::bodies::behind;
use super::operators::own_if;
use super::{Habit, Mend, habit};
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::{Code, Finding, Fix, Span};

/// `until if c then S`
pub(super) fn conditional(found: &Found<'_, '_>) -> Option<Habit> {
    let own = own_if(found)?;
    if !begins_transition(found, own) || !found.expects(Token::Else) || !is_transition(found) {
        return None;
    }
    let finding = habit("the condition of a transition needs no `if`")
        .at(found.span_at(own), "a transition always has one")
        .fix(Fix::sure("delete `if`").replace(with_gap(found, own), ""));
    let mend = Mend::Tokens(vec![(own..own + 1, Vec::new())]);
    Some(Habit { finding, mend })
}

/// `until c restart S`, `until if c resume S`
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
    let mut fix = Fix::sure(format!("write `{word}`"));
    let mut edits = Vec::new();
    // The word would not stand there behind an `if`: it goes, too.
    if let Some(own) = leading_if(found) {
        fix = Fix::sure(format!("write `{word}`, without `if`")).replace(with_gap(found, own), "");
        edits.push((own..own + 1, Vec::new()));
    }
    edits.push(found.instead(at, &[token]));
    let finding =
        habit("the next state follows `then`, or `continue` if it goes on where it was left")
            .at(found.span_at(at), "a word of another language")
            .fix(fix.replace(found.span_at(at), word));
    let mend = Mend::Tokens(edits);
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

/// `state S: y = x; until c then T;`
pub(super) fn no_let(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{Automaton, Colon, End, Eq, Ident, Initial, Let, State, Tel, Until};
    let at = found.fault.at;
    let before = [at.checked_sub(2), at.checked_sub(1)].map(|at| found.token(at?));
    let begins = match before {
        [Some(State), Some(Ident)] => found.token(at) == Some(Colon),
        _ => false,
    };
    let equation = [found.token(at + 1), found.token(at + 2)] == [Some(Ident), Some(Eq)];
    if !begins || !equation {
        return None;
    }
    let ends = |token| {
        matches!(
            token,
            Some(Automaton | End | Initial | State | Tel | Until) | None
        )
    };
    let end = (at + 1..=found.lexemes.len()).find(|at| ends(found.token(*at)))?;
    let finding = habit("the equations of a state stand between `let` and `tel`")
        .at(found.span_at(at), "expected `let`");
    if end == found.lexemes.len() || found.token(end) == Some(Automaton) {
        let finding = finding.help("`state S let y = x; tel until c then T;`");
        return Some(Habit {
            finding,
            mend: Mend::Usual,
        });
    }
    let fix = Fix::maybe("write `let` and `tel`")
        .replace(found.span_at(at), " let")
        .insert_before(found.span_at(end), "tel ");
    let mend = Mend::Tokens(vec![
        found.instead(at, &[Let]),
        found.before_token(end, Tel),
    ]);
    Some(Habit {
        finding: finding.fix(fix),
        mend,
    })
}

/// `automaton ... state S let ... tel tel`
pub(super) fn no_end(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{Automaton, End, Eq, Ident, State, Tel};
    let at = found.fault.at;
    let goes_on = match found.token(at) {
        None | Some(Tel) => true,
        Some(Ident) => found.token(at + 1) == Some(Eq),
        _ => false,
    };
    let before = (0..at).rev();
    let mut words = before.filter(|at| matches!(found.token(*at), Some(Automaton | End)));
    let open = words
        .next()
        .filter(|at| found.token(*at) == Some(Automaton))?;
    if !goes_on || !found.expects(End) || !found.expects(State) {
        return None;
    }
    let last = found.span_at(at - 1);
    let finding = Finding::new(Code::RPI0004, "this automaton has no end")
        .at(found.span_at(open), "no `end` for this `automaton`")
        .also(behind(last), "expected `end` here")
        .fix(Fix::sure("insert `end`").insert_after(last, "\nend"));
    let mend = Mend::Tokens(vec![found.before_token(at, End)]);
    Some(Habit { finding, mend })
}

/// Whether a token is the first of a transition.
fn begins_transition(found: &Found<'_, '_>, at: usize) -> bool {
    let before = at.checked_sub(1).and_then(|at| found.token(at));
    matches!(before, Some(Token::Until | Token::Unless | Token::Bar))
}

/// The `if` by which the transition with the fault begins.
fn leading_if(found: &Found<'_, '_>) -> Option<usize> {
    let mut before = (0..found.fault.at).rev();
    let first = before.find(|at| begins_transition(found, *at))?;
    (found.token(first) == Some(Token::If)).then_some(first)
}

/// A token with the gap behind it.
fn with_gap(found: &Found<'_, '_>, at: usize) -> Span {
    let (token, next) = (found.lexemes[at], found.lexemes[at + 1]);
    found.cx.span(token.start, next.start)
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
