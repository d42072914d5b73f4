//! Transitions of state machines in the syntax of SCADE and similar languages.

use super::bodies::behind;
use super::operators::own_if;
use super::{Habit, Mend, habit};
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::{Code, Finding, Fix, Span};

/// Recognises a transition with a needless `if`: `until if c then S`.
pub(super) fn conditional(found: &Found<'_, '_>) -> Option<Habit> {
    let own = own_if(found)?;
    if !begins_transition(found, own) || !found.expects(Token::Else) || !is_transition(found) {
        return None;
    }
    let finding = habit("the condition of a transition needs no `if`")
        .at(found.span_at(own), "a transition always has a condition")
        .fix(Fix::sure("delete `if`").replace(with_gap(found, own), ""));
    let mend = Mend::Tokens(vec![(own..own + 1, Vec::new())]);
    Some(Habit { finding, mend })
}

/// Recognises SCADE's words before the target state: `until c restart S`, `until if c resume S`.
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
    // The grammar stopped at this word with an unfinished `if`, so the `if` must be deleted too.
    if let Some(own) = leading_if(found) {
        fix = Fix::sure(format!("write `{word}`, without `if`")).replace(with_gap(found, own), "");
        edits.push((own..own + 1, Vec::new()));
    }
    edits.push(found.instead(at, &[token]));
    let finding =
        habit("write `then` before the next state, or `continue` to resume it where it was left")
            .at(found.span_at(at), "keyword of another language")
            .fix(fix.replace(found.span_at(at), word));
    let mend = Mend::Tokens(edits);
    Some(Habit { finding, mend })
}

/// Recognises two words before the target state: `until c then continue S`, `until c then resume S`.
pub(super) fn entry_twice(found: &Found<'_, '_>) -> Option<Habit> {
    // `resume` is an identifier here, so the grammar took it for the state and rejected the token after it.
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
    let finding =
        habit("the next state follows either `then`, or `continue` to resume it where it was left")
            .at(both, "one of the two words is enough")
            .fix(Fix::sure(title).replace(both, kept));
    let mend = Mend::Tokens(vec![
        found.instead(then, &[token]),
        (word..word + 1, Vec::new()),
    ]);
    Some(Habit { finding, mend })
}

/// Returns the fix title, the keyword and its token that replace `then` and the word after it.
fn second_word(written: &str) -> Option<(&'static str, &'static str, Token)> {
    match written {
        "continue" | "resume" => Some(("write `continue`", "continue", Token::Continue)),
        "restart" | "goto" => Some(("write `then`", "then", Token::Then)),
        _ => None,
    }
}

/// Recognises a strong transition after the body of its state: `state S let ... tel unless c then T;`.
pub(super) fn late_unless(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.token(at) != Some(Token::Unless) || !found.expects(Token::Until) {
        return None;
    }
    let name = 1 + state_before(found, at)?;
    let phrase = at..found.structure.phrase(at).end.max(at + 1);
    // Stop at the next transition, in case the `;` between the two is missing.
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
    // The order of transitions is their priority, so a move before another `unless` is not a sure fix.
    let fix = match found.token(name + 1) {
        Some(Token::Unless) => Fix::maybe(title),
        _ => Fix::sure(title),
    };
    let fix = fix
        .replace(behind(found.span_at(name)), format!(" {text};"))
        .replace(old, "");
    let finding = habit("`unless` is written before the body of its state")
        .at(
            found.span_at(at),
            "strong transitions are evaluated before the body",
        )
        .also(found.span_at(name), "must follow this name")
        .fix(fix);
    Some(Habit { finding, mend })
}

/// Recognises the body of a state without `let` and `tel`: `state S: y = x; until c then T;`.
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
    let finding = habit("the equations of a state are written between `let` and `tel`")
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

/// Recognises the body of a state without `tel`: `state S let y = x; until c then T;`.
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

/// Recognises an automaton without `end`: `automaton ... state S let ... tel tel`.
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

/// Reports that the block opened at token `open` lacks its closing keyword `end`, and inserts it at the error.
fn without_end(
    found: &Found<'_, '_>,
    what: &str,
    open: usize,
    (end, text): (Token, &str),
) -> Habit {
    let (at, word) = (found.fault.at, text.trim_start());
    let (begin, last) = (found.written(open), found.span_at(at - 1));
    let finding = Finding::new(Code::RPI0004, format!("this {what} is not closed"))
        .at(
            found.span_at(open),
            format!("this `{begin}` has no matching `{word}`"),
        )
        .also(behind(last), format!("expected `{word}` here"))
        .fix(Fix::sure(format!("insert `{word}`")).insert_after(last, text));
    let mend = Mend::Tokens(vec![found.before_token(at, end)]);
    Habit { finding, mend }
}

/// Returns whether token `at` is the first of a transition's condition.
fn begins_transition(found: &Found<'_, '_>, at: usize) -> bool {
    let before = at.checked_sub(1).and_then(|at| found.token(at));
    matches!(before, Some(Token::Until | Token::Unless | Token::Bar))
}

/// Returns the index of the `if` that begins the condition of the transition with the error.
fn leading_if(found: &Found<'_, '_>) -> Option<usize> {
    let mut before = (0..found.fault.at).rev();
    let first = before.find(|at| begins_transition(found, *at))?;
    (found.token(first) == Some(Token::If)).then_some(first)
}

/// Returns the span of token `at` with the white space after it.
fn with_gap(found: &Found<'_, '_>, at: usize) -> Span {
    let (token, next) = (found.lexemes[at], found.lexemes[at + 1]);
    found.cx.span(token.start, next.start)
}

/// Returns whether the syntax error is in a transition.
fn is_transition(found: &Found<'_, '_>) -> bool {
    let at = found.fault.at;
    let phrase = found.structure.phrase(at.saturating_sub(1));
    let mut before = (phrase.start.min(at)..at).map(|at| found.token(at));
    before.any(|token| matches!(token, Some(Token::Until | Token::Unless)))
}

/// Returns the index of the `state` keyword whose body ends before token `at`.
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
