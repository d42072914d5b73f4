//! Closing keywords of other languages, conditional expressions of Python, and automata in Lustre files.

use super::operators::{choice_fix, operand};
use super::{Habit, Mend, habit};
use crate::Mode;
use crate::declared;
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::{Code, Finding, Fix};
use std::ops::Range;

/// Recognises a body that is closed by `end` instead of `tel`: `let y = x; end`.
pub(super) fn end_for_tel(found: &Found<'_, '_>) -> Option<Habit> {
    let (open, end) = ended_body(found).or_else(|| ended_state(found))?;
    let finding = habit("a body ends with `tel`")
        .at(
            found.span_at(end),
            format!("`{}` does not close a body", found.written(end)),
        )
        .also(found.span_at(open), "the body begins here")
        .fix(Fix::sure("write `tel`").replace(found.span_at(end), "tel"));
    let mend = Mend::Tokens(vec![found.instead(end, &[Token::Tel])]);
    Some(Habit { finding, mend })
}

/// Returns the `let` of a declaration's body and the foreign `end` that closes it.
fn ended_body(found: &Found<'_, '_>) -> Option<(usize, usize)> {
    let last = found.lexemes.len().checked_sub(1)?;
    // If the closing word is an identifier, the grammar rejects the token after it.
    let is_there = found.fault.at == last && found.expects(Token::Tel) || found.fault.at > last;
    let open = found.structure.open_blocks().next()?;
    let is_body = found.token(open) == Some(Token::Let)
        && found.structure.open_blocks().nth(1).is_none()
        && matches!(found.token(last - 1), Some(Token::Semi | Token::Let));
    (is_there && is_body && is_end(found.written(last))).then_some((open, last))
}

/// Returns whether a word closes a body in another language.
fn is_end(word: &str) -> bool {
    const ENDS: [&str; 9] = [
        "end",
        "end_node",
        "endnode",
        "end_function",
        "endfunction",
        "end_function_block",
        "end_program",
        "endcommand",
        "end_command",
    ];
    ENDS.iter().any(|end| word.eq_ignore_ascii_case(end))
}

/// Returns the `let` of a state's body and the `end` that closes it.
///
/// That `end` does not belong to the automaton: a transition, another state or the automaton's own `end` follows.
fn ended_state(found: &Found<'_, '_>) -> Option<(usize, usize)> {
    use Token::{End, State, Tel, Unless, Until};
    let end = found.fault.at;
    let goes_on = matches!(found.token(end + 1), Some(End | State | Unless | Until));
    let is_there = found.token(end) == Some(End) && found.expects(Tel) && goes_on;
    let open = (0..end)
        .rev()
        .find(|at| found.token(*at) == Some(Token::Let))?;
    is_there.then_some((open, end))
}

/// Recognises the conditional expression of Python: `y = a if c else b`.
pub(super) fn choice_behind(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    if found.token(at) != Some(Token::If) || !found.expects(Token::Plus) {
        return None;
    }
    let (start, end) = operand(found, at);
    let other = (at + 1..end).find(|at| found.token(*at) == Some(Token::Else))?;
    let has_then = (at..other).any(|at| found.token(at) == Some(Token::Then));
    if has_then {
        return None;
    }
    let values = [at + 1..other, start..at, other + 1..end];
    if values.iter().any(Range::is_empty) {
        return None;
    }
    let [c, a, b] = values.clone().map(|range| found.text(range));
    let meant = format!("if {c} then {a} else {b}");
    let place = found.span_of(start..end);
    let finding = habit("a conditional expression is written `if c then x else y`")
        .at(found.span_at(at), "the condition must come first")
        .fix(choice_fix(found, start..end, format!("write `{meant}`")).replace(place, meant));
    let [c, a, b] = values.map(|range| found.lexemes[range].to_vec());
    let word = |token| found.instead(at, &[token]).1;
    let parts = [
        word(Token::If),
        c,
        word(Token::Then),
        a,
        word(Token::Else),
        b,
    ];
    // The tokens are out of text order now, but each keeps its own location for later diagnostics.
    let mend = Mend::Tokens(vec![(start..end, parts.concat())]);
    Some(Habit { finding, mend })
}

/// Recognises an automaton in a Lustre file: `automaton initial state S ... end`.
pub(super) fn automaton_in_lustre(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at.checked_sub(1)?;
    let begins = matches!(found.written(at + 1), "initial" | "state");
    if found.cx.mode != Mode::Lustre || found.written(at) != "automaton" || !begins {
        return None;
    }
    let mut after = (at..found.lexemes.len()).rev();
    let end = after.find(|at| found.written(*at) == "end");
    let end = end.map_or(found.lexemes.len() - 1, |end| end + 1);
    let finding = Finding::new(Code::RPI0001, "automata are not supported in Lustre files")
        .at(found.span_at(at), "Lustre has no automata")
        .help("rename the file to `.rpi`: it supports automata and the Lustre syntax");
    Some(Habit {
        finding,
        mend: Mend::Phrase(
            at..end,
            declared::inside(found.cx, &found.lexemes[at..end]).collect(),
        ),
    })
}
