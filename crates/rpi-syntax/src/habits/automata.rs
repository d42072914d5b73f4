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

/// `until c then continue S`, `until c then resume S`
pub(super) fn entry_twice(found: &Found<'_, '_>) -> Option<Habit> {
    // Where it is no word of its own it was taken for the name of the state.
    let at = found.fault.at;
    let mut places = [at, at.saturating_sub(1)].into_iter();
    let word = places.find(|word| second_word(found.written(*word)).is_some())?;
    let (title, kept, token) = second_word(found.written(word))?;
    let then = word.checked_sub(1)?;
    let is_doubled =
        found.token(then) == Some(Token::Then) && found.token(word + 1) == Some(Token::Ident);
    if !is_doubled || !is_transition(found) {
        return None;
    }
    let both = found.span_at(then).merge(found.span_at(word));
    let finding = habit(
        "the next state follows `then` alone, or `continue` alone if it goes on where it was left",
    )
    .at(both, "one of the two words is enough")
    .fix(Fix::sure(title).replace(both, kept));
    let mend = Mend::Tokens(vec![
        found.instead(then, &[token]),
        (word..word + 1, Vec::new()),
    ]);
    Some(Habit { finding, mend })
}

/// What to write for a word behind `then`, and with which title.
fn second_word(written: &str) -> Option<(&'static str, &'static str, Token)> {
    match written {
        "continue" | "resume" => Some(("write `continue`", "continue", Token::Continue)),
        "restart" | "goto" => Some(("write `then`", "then", Token::Then)),
        _ => None,
    }
}

/// `state S let ... tel unless c then T;`
pub(super) fn late_unless(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.token(at) != Some(Token::Unless) || !found.expects(Token::Until) {
        return None;
    }
    let name = 1 + state_before(found, at)?;
    let phrase = at..found.structure.phrase(at).end.max(at + 1);
    // A sign that is missing between the two does not make them one.
    let mut words = at + 1..phrase.end;
    let next = words.find(|at| matches!(found.token(*at), Some(Token::Until | Token::Unless)));
    let (end, last, mend) = match next {
        Some(next) => (next, next - 1, Mend::Tokens(vec![(at..next, Vec::new())])),
        None => (
            phrase.end,
            phrase.end.min(found.lexemes.len() - 1),
            Mend::Phrase(phrase, Vec::new()),
        ),
    };
    let old = found
        .cx
        .span(found.lexemes[at - 1].end, found.lexemes[last].end);
    let text = found.text(at..end).to_owned();
    let title = "put it before the body";
    // Of two transitions the first goes before the other.
    let fix = match found.token(name + 1) {
        Some(Token::Unless) => Fix::maybe(title),
        _ => Fix::sure(title),
    };
    let fix = fix
        .replace(behind(found.span_at(name)), format!(" {text};"))
        .replace(old, "");
    let finding = habit("`unless` stands before the body of its state")
        .at(
            found.span_at(at),
            "a strong transition is decided before the body is computed",
        )
        .also(found.span_at(name), "it belongs behind this name")
        .fix(fix);
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

/// `state S let y = x; until c then T;`
pub(super) fn open_state(found: &Found<'_, '_>) -> Option<Habit> {
    use Token::{Automaton, End, Initial, Let, State, Tel, Until};
    let at = found.fault.at;
    let goes_on = matches!(found.token(at), Some(Until | State | Initial | End));
    let mut before = (0..at).rev();
    let open = before.find(|at| matches!(found.token(*at), Some(Let | Tel)))?;
    let head =
        before.find(|at| matches!(found.token(*at), Some(State | Let | Tel | End | Automaton)));
    let is_state = head.is_some_and(|head| found.token(head) == Some(State));
    if !goes_on || !is_state || found.token(open) != Some(Let) || !found.expects(Tel) {
        return None;
    }
    Some(without_end(found, "state", open, (Tel, " tel")))
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
    Some(without_end(found, "automaton", open, (End, "\nend")))
}

/// What begins with the token `open` lacks its last word before the token with the fault.
fn without_end(
    found: &Found<'_, '_>,
    what: &str,
    open: usize,
    (end, text): (Token, &str),
) -> Habit {
    let (at, word) = (found.fault.at, text.trim_start());
    let (begin, last) = (found.written(open), found.span_at(at - 1));
    let finding = Finding::new(Code::RPI0004, format!("this {what} has no end"))
        .at(
            found.span_at(open),
            format!("no `{word}` for this `{begin}`"),
        )
        .also(behind(last), format!("expected `{word}` here"))
        .fix(Fix::sure(format!("insert `{word}`")).insert_after(last, text));
    let mend = Mend::Tokens(vec![found.before_token(at, end)]);
    Habit { finding, mend }
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
