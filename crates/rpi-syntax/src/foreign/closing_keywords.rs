//! Closing keywords of other languages, conditional expressions of Python, and automata in Lustre files.

use super::conditional_extent::{has_own_operator, with_extent_fix};
use super::operators::operand_range;
use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::Dialect;
use crate::guessed_declarations;
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Code, Diagnostic, Fix};
use std::ops::Range;

/// Recognises a body that is closed by `end` instead of `tel`: `let y = x; end`.
pub(super) fn end_for_tel(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let (open, end) = body_closed_by_end(found).or_else(|| state_closed_by_end(found))?;
    let diagnostic = foreign_syntax("a body ends with `tel`")
        .primary(
            found.token_span(end),
            format!("`{}` does not close a body", found.source_text(end)),
        )
        .secondary(found.token_span(open), "the body begins here")
        .fix(Fix::sure("write `tel`").replace(found.token_span(end), "tel"));
    let repair = Repair::ReplaceTokens(vec![found.replacement(end, &[Token::Tel])]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Returns the token indices of the `let` of a declaration's body and of the last word, such as `end`, that closes it
/// in another language; `None` if the body is closed otherwise.
fn body_closed_by_end(found: &ErrorContext<'_, '_>) -> Option<(usize, usize)> {
    let last = found.lexemes.len().checked_sub(1)?;
    // If the closing word is an identifier, the grammar rejects the token after it.
    let is_there =
        found.error.index == last && found.expects(Token::Tel) || found.error.index > last;
    let open = found.structure.unclosed_blocks().next()?;
    let is_body = found.token_at(open) == Some(Token::Let)
        && found.structure.unclosed_blocks().nth(1).is_none()
        && matches!(found.token_at(last - 1), Some(Token::Semi | Token::Let));
    (is_there && is_body && closes_foreign_body(found.source_text(last))).then_some((open, last))
}

/// Returns whether the word closes a body in another language, as `end_function` does.
fn closes_foreign_body(word: &str) -> bool {
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

/// Returns the token indices of the `let` of a state's body and of the `end` that closes it. `None` unless the syntax
/// error is at such an `end`.
///
/// The `end` does not close the automaton, because a transition, another state or a further `end` follows.
fn state_closed_by_end(found: &ErrorContext<'_, '_>) -> Option<(usize, usize)> {
    use Token::{End, State, Tel, Unless, Until};
    let end = found.error.index;
    let goes_on = matches!(found.token_at(end + 1), Some(End | State | Unless | Until));
    let is_there = found.token_at(end) == Some(End) && found.expects(Tel) && goes_on;
    let open = (0..end)
        .rev()
        .find(|at| found.token_at(*at) == Some(Token::Let))?;
    is_there.then_some((open, end))
}

/// Recognises the conditional expression of Python: `y = a if c else b`.
pub(super) fn python_conditional(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    if found.token_at(at) != Some(Token::If) || !found.expects(Token::Plus) {
        return None;
    }
    let (start, end) = operand_range(found, at);
    let other = (at + 1..end).find(|at| found.token_at(*at) == Some(Token::Else))?;
    let has_then = (at..other).any(|at| found.token_at(at) == Some(Token::Then));
    if has_then {
        return None;
    }
    let values = [at + 1..other, start..at, other + 1..end];
    if values.iter().any(Range::is_empty) {
        return None;
    }
    let [c, a, b] = values.clone().map(|range| found.range_text(range));
    let meant = format!("if {c} then {a} else {b}");
    let place = found.range_span(start..end);
    let diagnostic = foreign_syntax("a conditional expression is written `if c then x else y`")
        .primary(found.token_span(at), "the condition must come first");
    if has_own_operator(found, start..end) {
        return Some(ForeignSyntax {
            diagnostic: with_extent_fix(found, diagnostic, [start..at, other + 1..end], |a, b| {
                format!("if {c} then {a} else {b}")
            }),
            repair: Repair::RemoveErrorPhrase,
        });
    }
    let fix = Fix::sure(format!("write `{meant}`")).replace(place, meant);
    let diagnostic = diagnostic.fix(fix);
    let [c, a, b] = values.map(|range| found.lexemes[range].to_vec());
    let word = |token| found.replacement(at, &[token]).1;
    let parts = [
        word(Token::If),
        c,
        word(Token::Then),
        a,
        word(Token::Else),
        b,
    ];
    // The tokens are out of text order now, but each keeps its own location for later diagnostics.
    let repair = Repair::ReplaceTokens(vec![(start..end, parts.concat())]);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Recognises an automaton in a Lustre file, where RPI does not accept automata: `automaton initial state S ... end`.
pub(super) fn automaton_in_lustre(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index.checked_sub(1)?;
    let begins = matches!(found.source_text(at + 1), "initial" | "state");
    if found.cx.dialect != Dialect::Lustre || found.source_text(at) != "automaton" || !begins {
        return None;
    }
    let mut after = (at..found.lexemes.len()).rev();
    let end = after.find(|at| found.source_text(*at) == "end");
    let end = end.map_or(found.lexemes.len() - 1, |end| end + 1);
    let diagnostic = Diagnostic::new(Code::RPI0001, "automata are not supported in Lustre files")
        .primary(found.token_span(at), "Lustre has no automata")
        .help("rename the file to `.rpi`: it supports automata and the Lustre syntax");
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemovePhrase(
            at..end,
            guessed_declarations::inner_targets(found.cx, &found.lexemes[at..end]).collect(),
        ),
    })
}
