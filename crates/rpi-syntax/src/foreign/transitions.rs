//! Transitions of state machines in the syntax of SCADE and similar languages.

use super::imperative::end_of_span;
use super::operators::innermost_if;
use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Code, Diagnostic, Fix, Span};

/// Recognises a redundant `if` in a transition: `until if c then S`.
pub(super) fn transition_with_if(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let own = innermost_if(found)?;
    if !begins_transition(found, own) || !found.expects(Token::Else) || !in_transition(found) {
        return None;
    }
    let diagnostic = foreign_syntax("the condition of a transition needs no `if`")
        .primary(found.token_span(own), "a transition always has a condition")
        .fix(Fix::sure("delete `if`").replace(span_with_trailing_space(found, own), ""));
    let repair = Repair::ReplaceTokens(vec![(own..own + 1, Vec::new())]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises the words of SCADE before a target state: `until c restart S`, `until if c resume S`.
pub(super) fn foreign_target_word(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let (word, token) = match found.source_text(at) {
        "restart" | "goto" => ("then", Token::Then),
        "resume" => ("continue", Token::Continue),
        _ => return None,
    };
    if !found.expects(Token::Then) || !in_transition(found) {
        return None;
    }
    let mut fix = Fix::sure(format!("write `{word}`"));
    let mut edits = Vec::new();
    // The grammar stopped at this word with an unfinished `if`, so the `if` must be deleted too.
    if let Some(own) = leading_if(found) {
        fix = Fix::sure(format!("write `{word}`, without `if`"))
            .replace(span_with_trailing_space(found, own), "");
        edits.push((own..own + 1, Vec::new()));
    }
    edits.push(found.replacement(at, &[token]));
    let diagnostic = foreign_syntax(
        "write `then` before the next state, or `continue` to resume it where it was left",
    )
    .primary(found.token_span(at), "keyword of another language")
    .fix(fix.replace(found.token_span(at), word));
    let repair = Repair::ReplaceTokens(edits);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises two words before a target state, where RPI needs one: `until c then continue S`, `until c then resume S`.
pub(super) fn doubled_target_word(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    // `resume` is an identifier here, so the grammar took it for the state and rejected the token after it.
    let at = found.error.index;
    let mut places = [at, at.saturating_sub(1)].into_iter();
    let word = places.find(|word| target_word_fix(found.source_text(*word)).is_some())?;
    let (title, kept, token) = target_word_fix(found.source_text(word))?;
    let then = word.checked_sub(1)?;
    let is_doubled =
        found.token_at(then) == Some(Token::Then) && found.token_at(word + 1) == Some(Token::Ident);
    if !is_doubled || !in_transition(found) {
        return None;
    }
    let both = found.token_span(then).merge(found.token_span(word));
    let diagnostic = foreign_syntax(
        "the next state follows either `then`, or `continue` to resume it where it was left",
    )
    .primary(both, "one of the two words is enough")
    .fix(Fix::sure(title).replace(both, kept));
    let repair = Repair::ReplaceTokens(vec![
        found.replacement(then, &[token]),
        (word..word + 1, Vec::new()),
    ]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Returns the title of a fix, the RPI keyword and its token that replace `then` and the word `written` after it, such
/// as `resume`. `None` for other words.
fn target_word_fix(written: &str) -> Option<(&'static str, &'static str, Token)> {
    match written {
        "continue" | "resume" => Some(("write `continue`", "continue", Token::Continue)),
        "restart" | "goto" => Some(("write `then`", "then", Token::Then)),
        _ => None,
    }
}

/// Recognises a strong transition after the body of its state: `state S let ... tel unless c then T;`.
pub(super) fn unless_after_body(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    if found.token_at(at) != Some(Token::Unless) || !found.expects(Token::Until) {
        return None;
    }
    let name = 1 + state_before(found, at)?;
    let phrase = at..found.structure.phrase(at).end.max(at + 1);
    // Stop at the next transition, in case the `;` between the two is missing.
    let mut words = at + 1..phrase.end;
    let next = words.find(|at| matches!(found.token_at(*at), Some(Token::Until | Token::Unless)));
    let (end, last, repair) = match next {
        Some(next) => (
            next,
            next - 1,
            Repair::ReplaceTokens(vec![(at..next, Vec::new())]),
        ),
        None => (
            phrase.end,
            phrase.end.min(found.lexemes.len() - 1),
            Repair::RemovePhrase(phrase, Vec::new()),
        ),
    };
    let old = found
        .cx
        .span(found.lexemes[at - 1].end, found.lexemes[last].end);
    let text = found.range_text(at..end).to_owned();
    let title = "put it before the body";
    // The order of transitions is their priority, so a move before another `unless` is not a sure fix.
    let fix = match found.token_at(name + 1) {
        Some(Token::Unless) => Fix::maybe(title),
        _ => Fix::sure(title),
    };
    let fix = fix
        .replace(end_of_span(found.token_span(name)), format!(" {text};"))
        .replace(old, "");
    let diagnostic = foreign_syntax("`unless` is written before the body of its state")
        .primary(
            found.token_span(at),
            "strong transitions are evaluated before the body",
        )
        .secondary(found.token_span(name), "must follow this name")
        .fix(fix);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises the body of a state without `let` and `tel`: `state S: y = x; until c then T;`.
pub(super) fn state_without_let(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Automaton, Colon, End, Eq, Ident, Initial, Let, State, Tel, Until};
    let at = found.error.index;
    let before = [at.checked_sub(2), at.checked_sub(1)].map(|at| found.token_at(at?));
    let begins = match before {
        [Some(State), Some(Ident)] => found.token_at(at) == Some(Colon),
        _ => false,
    };
    let equation = [found.token_at(at + 1), found.token_at(at + 2)] == [Some(Ident), Some(Eq)];
    if !begins || !equation {
        return None;
    }
    let ends = |token| {
        matches!(
            token,
            Some(Automaton | End | Initial | State | Tel | Until) | None
        )
    };
    let end = (at + 1..=found.lexemes.len()).find(|at| ends(found.token_at(*at)))?;
    let diagnostic = foreign_syntax("the equations of a state are written between `let` and `tel`")
        .primary(found.token_span(at), "expected `let`");
    if end == found.lexemes.len() || found.token_at(end) == Some(Automaton) {
        let diagnostic = diagnostic.help("`state S let y = x; tel until c then T;`");
        return Some(ForeignSyntax {
            diagnostic,
            repair: Repair::RemoveErrorPhrase,
        });
    }
    let fix = Fix::maybe("write `let` and `tel`")
        .replace(found.token_span(at), " let")
        .insert_before(found.token_span(end), "tel ");
    let repair = Repair::ReplaceTokens(vec![
        found.replacement(at, &[Let]),
        found.insertion(end, Tel),
    ]);
    Some(ForeignSyntax {
        diagnostic: diagnostic.fix(fix),
        repair,
    })
}

/// Recognises the body of a state without `tel`: `state S let y = x; until c then T;`.
pub(super) fn state_without_tel(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Automaton, End, Initial, Let, State, Tel, Until};
    let at = found.error.index;
    let goes_on = matches!(found.token_at(at), Some(Until | State | Initial | End));
    let mut before = (0..at).rev();
    let open = before.find(|at| matches!(found.token_at(*at), Some(Let | Tel)))?;
    let head = before.find(|at| {
        matches!(
            found.token_at(*at),
            Some(State | Let | Tel | End | Automaton)
        )
    });
    let is_state = head.is_some_and(|head| found.token_at(head) == Some(State));
    if !goes_on || !is_state || found.token_at(open) != Some(Let) || !found.expects(Tel) {
        return None;
    }
    Some(unclosed_block(found, "state", open, (Tel, " tel")))
}

/// Recognises an automaton without `end`: `automaton ... state S let ... tel tel`.
pub(super) fn automaton_without_end(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    use Token::{Automaton, End, Eq, Ident, State, Tel};
    let at = found.error.index;
    let goes_on = match found.token_at(at) {
        None | Some(Tel) => true,
        Some(Ident) => found.token_at(at + 1) == Some(Eq),
        _ => false,
    };
    let before = (0..at).rev();
    let mut words = before.filter(|at| matches!(found.token_at(*at), Some(Automaton | End)));
    let open = words
        .next()
        .filter(|at| found.token_at(*at) == Some(Automaton))?;
    if !goes_on || !found.expects(End) || !found.expects(State) {
        return None;
    }
    Some(unclosed_block(found, "automaton", open, (End, "\nend")))
}

/// Reports that the block opened at token `open` lacks its closing keyword, and inserts the keyword at the syntax
/// error. `what` names the block in the message; `(end, text)` are the token and the inserted text.
fn unclosed_block(
    found: &ErrorContext<'_, '_>,
    what: &str,
    open: usize,
    (end, text): (Token, &str),
) -> ForeignSyntax {
    let (at, word) = (found.error.index, text.trim_start());
    let (begin, last) = (found.source_text(open), found.token_span(at - 1));
    let diagnostic = Diagnostic::new(Code::RPI0004, format!("this {what} is not closed"))
        .primary(
            found.token_span(open),
            format!("this `{begin}` has no matching `{word}`"),
        )
        .secondary(end_of_span(last), format!("expected `{word}` here"))
        .fix(Fix::sure(format!("insert `{word}`")).insert_after(last, text));
    let repair = Repair::ReplaceTokens(vec![found.insertion(at, end)]);
    ForeignSyntax { diagnostic, repair }
}

/// Returns whether token `at` is the first token of the condition of a transition: whether `until`, `unless` or `|`
/// precedes it.
fn begins_transition(found: &ErrorContext<'_, '_>, at: usize) -> bool {
    let before = at.checked_sub(1).and_then(|at| found.token_at(at));
    matches!(before, Some(Token::Until | Token::Unless | Token::Bar))
}

/// Returns the token index of a redundant `if` at the start of the condition in the transition with the syntax error;
/// `None` if there is none.
fn leading_if(found: &ErrorContext<'_, '_>) -> Option<usize> {
    let mut before = (0..found.error.index).rev();
    let first = before.find(|at| begins_transition(found, *at))?;
    (found.token_at(first) == Some(Token::If)).then_some(first)
}

/// Returns the span of token `at` including the white space after it.
fn span_with_trailing_space(found: &ErrorContext<'_, '_>, at: usize) -> Span {
    let (token, next) = (found.lexemes[at], found.lexemes[at + 1]);
    found.cx.span(token.start, next.start)
}

/// Returns whether the syntax error is in a transition.
fn in_transition(found: &ErrorContext<'_, '_>) -> bool {
    let at = found.error.index;
    let phrase = found.structure.phrase(at.saturating_sub(1));
    let mut before = (phrase.start.min(at)..at).map(|at| found.token_at(at));
    before.any(|token| matches!(token, Some(Token::Until | Token::Unless)))
}

/// Returns the token index of the nearest `state` keyword before token `at`, skipping complete bodies; `None` if there
/// is none.
fn state_before(found: &ErrorContext<'_, '_>, at: usize) -> Option<usize> {
    let mut at = at;
    loop {
        at = at.checked_sub(1)?;
        match found.token_at(at)? {
            Token::State => return Some(at),
            Token::Tel => at = found.structure.partner(at)?,
            _ => {}
        }
    }
}
