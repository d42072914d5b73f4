//! Misspelt keywords.

use super::{Habit, Mend};
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::{Code, Finding, Fix};

/// Keywords that begin statements.
const STATEMENTS: &[Token] = &[
    Token::Assert,
    Token::Automaton,
    Token::Check,
    Token::Export,
    Token::Fail,
    Token::Finish,
    Token::Fragment,
    Token::Yield,
];

/// Operators written as words. A similar word, such as `nand` or `xnor`, may be another operator, not a misspelling.
const OPERATORS: &[&str] = &[
    "and", "or", "xor", "nor", "not", "mod", "div", "when", "fby", "pre", "last", "current",
];

/// Shortest word that is compared, in bytes. Shorter ones resemble too many words.
const SHORTEST: usize = 3;

/// Longest word after a number that is taken for a unit, in bytes.
const LONGEST_UNIT: usize = 3;

/// Recognises a misspelt keyword: `(x: int) retuns (y: int)`.
pub(super) fn word(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    // After a number, a short word is a unit, unless it resembles `then` or `else`.
    let goes_on = |word: &str| matches!(word, "then" | "else");
    let is_unit = matches!(found.token_before(), Some(Token::Int | Token::Real))
        && found.written(at).len() <= LONGEST_UNIT
        && !nearest(found, at, &found.fault.expected).is_some_and(|word| goes_on(&word));
    let written = found.written(at);
    let is_name = written.len() < SHORTEST || found.cx.seeming.declares(written);
    if found.token(at) != Some(Token::Ident) || is_unit || is_name || found.lacks_semi() {
        return None;
    }
    let is_clear = is_only_one(found, at, &found.fault.expected)
        && nearest(found, at, &found.fault.expected)
            .is_some_and(|word| !OPERATORS.contains(&&*word));
    let fix = if is_clear { Fix::sure } else { Fix::maybe };
    meant(found, at, &found.fault.expected, fix)
}

/// Returns whether the nearest keyword is unambiguous: no other accepted keyword is similar, and no name is equal.
fn is_only_one(found: &Found<'_, '_>, at: usize, words: &[Token]) -> bool {
    let meant = nearest(found, at, words);
    let others: Vec<Token> = words
        .iter()
        .copied()
        .filter(|word| word.spelling() != meant.as_deref())
        .collect();
    let occurs = |other: usize| other != at && found.written(other) == found.written(at);
    nearest(found, at, &others).is_none() && !(0..found.lexemes.len()).any(occurs)
}

/// Recognises a misspelt keyword that the grammar took for the name of a flow: `finsh done when c;`.
pub(super) fn statement(found: &Found<'_, '_>) -> Option<Habit> {
    let at = taken_for_a_flow(found)?;
    let is_long = found.written(at).len() >= SHORTEST;
    is_long.then(|| meant(found, at, STATEMENTS, Fix::maybe))?
}

/// Recognises a misspelt `tel` that the grammar took for the name of a flow: `let y = x; tl`.
pub(super) fn tel(found: &Found<'_, '_>) -> Option<Habit> {
    let at = taken_for_a_flow(found)?;
    found.structure.open_let()?;
    let is_name = (0..at).any(|other| found.written(other) == found.written(at));
    if is_name {
        return None;
    }
    meant(found, at, &[Token::Tel], Fix::maybe)
}

/// Returns the name before the rejected token, if it is the first token of a statement and `=` was expected after it.
fn taken_for_a_flow(found: &Found<'_, '_>) -> Option<usize> {
    let at = found.fault.at.checked_sub(1)?;
    let begins = at.checked_sub(1).and_then(|before| found.token(before));
    let is_first = matches!(
        begins,
        Some(Token::Let | Token::Semi | Token::Tel | Token::End)
    );
    let is_name = found.token(at) == Some(Token::Ident) && found.expects(Token::Eq);
    (is_first && is_name).then_some(at)
}

/// Reports that token `at` resembles one of `words`, and replaces it by the nearest one.
fn meant(
    found: &Found<'_, '_>,
    at: usize,
    words: &[Token],
    fix: fn(String) -> Fix,
) -> Option<Habit> {
    let written = found.written(at);
    let meant = nearest(found, at, words)?;
    let token = Token::of_spelling(&meant)?;
    let span = found.span_at(at);
    let message = format!("`{written}` is not a keyword");
    let finding = Finding::new(Code::RPI0001, message)
        .at(span, format!("did you mean `{meant}`?"))
        .fix(fix(format!("write `{meant}`")).replace(span, meant));
    let mut edits = vec![found.instead(at, &[token])];
    // After `then`, `end` is the target state, which the grammar expects as an identifier.
    if token == Token::Then && found.token(at + 1) == Some(Token::End) {
        edits.push(found.instead(at + 1, &[Token::Ident]));
    }
    let mend = Mend::Tokens(edits);
    Some(Habit { finding, mend })
}

/// Returns the keyword among `words` that is most similar to token `at`.
fn nearest(found: &Found<'_, '_>, at: usize, words: &[Token]) -> Option<String> {
    let is_there = |token: &&Token| {
        let word = token.keyword();
        word.is_some_and(|word| word.is_in(found.cx.mode) && word.text.len() >= SHORTEST)
    };
    let near = words.iter().filter(is_there).filter_map(|t| t.spelling());
    rpi_diag::suggest(found.written(at), near)
}
