//! Words of the language that lack a letter, have one too many or a wrong one.

use super::{Habit, Mend};
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::{Code, Finding, Fix};

/// Words by which statements begin.
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

/// Operators: `nand`, `xnor` and `unwhen` are not misspelt, but others.
const OPERATORS: &[&str] = &[
    "and", "or", "xor", "nor", "not", "mod", "div", "when", "fby", "pre", "last", "current",
];

/// Shorter words resemble too much.
const SHORTEST: usize = 3;

/// Longer ones are hardly units.
const LONGEST_UNIT: usize = 3;

/// `(x: int) retuns (y: int)`
pub(super) fn word(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    // Behind a number a short word is a unit, unless it resembles how a choice goes on.
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

/// Whether no other word resembles what is written as much, neither one that fits nor a name.
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

/// `finsh done when c;`, where the word was taken for the name of a flow
pub(super) fn statement(found: &Found<'_, '_>) -> Option<Habit> {
    let at = taken_for_a_flow(found)?;
    let is_long = found.written(at).len() >= SHORTEST;
    is_long.then(|| meant(found, at, STATEMENTS, Fix::maybe))?
}

/// `let y = x; tl`, where the word was taken for the name of a flow
pub(super) fn tel(found: &Found<'_, '_>) -> Option<Habit> {
    let at = taken_for_a_flow(found)?;
    found.structure.open_let()?;
    let is_name = (0..at).any(|other| found.written(other) == found.written(at));
    if is_name {
        return None;
    }
    meant(found, at, &[Token::Tel], Fix::maybe)
}

/// The first word of a statement, behind which the fault is: a name where only `=` was missing.
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

/// The word among these that is nearest to the one that is written.
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
    let message = format!("`{written}` is no word of the language");
    let finding = Finding::new(Code::RPI0001, message)
        .at(span, format!("did you mean `{meant}`?"))
        .fix(fix(format!("write `{meant}`")).replace(span, meant));
    let mut edits = vec![found.instead(at, &[token])];
    // Behind the right word it is the name of what follows.
    if token == Token::Then && found.token(at + 1) == Some(Token::End) {
        edits.push(found.instead(at + 1, &[Token::Ident]));
    }
    let mend = Mend::Tokens(edits);
    Some(Habit { finding, mend })
}

/// The word among these that resembles the one that is written the most.
fn nearest(found: &Found<'_, '_>, at: usize, words: &[Token]) -> Option<String> {
    let is_there = |token: &&Token| {
        let word = token.keyword();
        word.is_some_and(|word| word.is_in(found.cx.mode) && word.text.len() >= SHORTEST)
    };
    let near = words.iter().filter(is_there).filter_map(|t| t.spelling());
    rpi_diag::suggest(found.written(at), near)
}
