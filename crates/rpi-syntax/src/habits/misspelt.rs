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

/// Shorter words resemble too much.
const SHORTEST: usize = 3;

/// Longer ones are hardly units.
const LONGEST_UNIT: usize = 3;

/// `(x: int) retuns (y: int)`
pub(super) fn word(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    // Behind a number a short word is a unit.
    let is_unit = matches!(found.token_before(), Some(Token::Int | Token::Real))
        && found.written(at).len() <= LONGEST_UNIT;
    if found.token(at) != Some(Token::Ident) || is_unit || found.lacks_semi() {
        return None;
    }
    meant(found, at, &found.fault.expected, Fix::sure)
}

/// `finsh done when c;`, where the word was taken for the name of a flow
pub(super) fn statement(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at.checked_sub(1)?;
    let begins = at.checked_sub(1).and_then(|before| found.token(before));
    let is_first = matches!(
        begins,
        Some(Token::Let | Token::Semi | Token::Tel | Token::End)
    );
    let is_name = found.token(at) == Some(Token::Ident) && found.expects(Token::Eq);
    if !is_first || !is_name {
        return None;
    }
    meant(found, at, STATEMENTS, Fix::maybe)
}

/// The word among these that is nearest to the one that is written.
fn meant(
    found: &Found<'_, '_>,
    at: usize,
    words: &[Token],
    fix: fn(String) -> Fix,
) -> Option<Habit> {
    let written = found.written(at);
    let is_there = |token: &&Token| {
        let word = token.keyword();
        word.is_some_and(|word| word.is_in(found.cx.mode) && word.text.len() >= SHORTEST)
    };
    let near = words.iter().filter(is_there).filter_map(|t| t.spelling());
    let meant = rpi_diag::suggest(written, near).filter(|_| written.len() >= SHORTEST)?;
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
