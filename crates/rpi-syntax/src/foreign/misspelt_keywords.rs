//! Misspelt keywords.

use super::{ForeignSyntax, Repair};
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Code, Diagnostic, Fix};

/// Keywords that begin statements, as candidates for a misspelt first word.
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

/// Operators written as words. An unknown word that resembles one, such as `nand`, may be another operator instead of a
/// misspelling.
const OPERATORS: &[&str] = &[
    "and", "or", "xor", "nor", "not", "mod", "div", "when", "fby", "pre", "last", "current",
];

/// Minimum length in bytes of a word that is compared with keywords. Shorter words resemble too many others.
const MIN_LEN: usize = 3;

/// Maximum length in bytes of a word after a number that may be a unit instead of a misspelt keyword.
const MAX_UNIT_LEN: usize = 3;

/// Recognises a misspelt keyword: `(x: int) retuns (y: int)`.
pub(super) fn keyword(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    // After a number, a short word is a unit, unless it resembles `then` or `else`.
    let goes_on = |word: &str| matches!(word, "then" | "else");
    let is_unit = matches!(found.token_before(), Some(Token::Int | Token::Real))
        && found.source_text(at).len() <= MAX_UNIT_LEN
        && !nearest_keyword(found, at, &found.error.expected).is_some_and(|word| goes_on(&word));
    let written = found.source_text(at);
    let is_name = written.len() < MIN_LEN || found.cx.guessed_names.declares(written);
    if found.token_at(at) != Some(Token::Ident) || is_unit || is_name || found.lacks_semi() {
        return None;
    }
    let is_clear = is_unambiguous(found, at, &found.error.expected)
        && nearest_keyword(found, at, &found.error.expected)
            .is_some_and(|word| !OPERATORS.contains(&&*word));
    let fix = if is_clear { Fix::sure } else { Fix::maybe };
    replace_keyword(found, at, &found.error.expected, fix)
}

/// Returns whether the misspelt word at token `at` resembles only one of the keywords `words`, and occurs nowhere else
/// in the declaration.
fn is_unambiguous(found: &ErrorContext<'_, '_>, at: usize, words: &[Token]) -> bool {
    let meant = nearest_keyword(found, at, words);
    let others: Vec<Token> = words
        .iter()
        .copied()
        .filter(|word| word.spelling() != meant.as_deref())
        .collect();
    let occurs = |other: usize| other != at && found.source_text(other) == found.source_text(at);
    nearest_keyword(found, at, &others).is_none() && !(0..found.lexemes.len()).any(occurs)
}

/// Recognises a misspelt keyword that the grammar took for the name of a flow: `finsh done when c;`.
pub(super) fn statement_keyword(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = taken_for_a_flow(found)?;
    let is_long = found.source_text(at).len() >= MIN_LEN;
    is_long.then(|| replace_keyword(found, at, STATEMENTS, Fix::maybe))?
}

/// Recognises a misspelt `tel` that the grammar took for the name of a flow: `let y = x; tl`.
pub(super) fn tel(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = taken_for_a_flow(found)?;
    found.structure.unclosed_let()?;
    let is_name = (0..at).any(|other| found.source_text(other) == found.source_text(at));
    if is_name {
        return None;
    }
    replace_keyword(found, at, &[Token::Tel], Fix::maybe)
}

/// Returns the token index of a name before the rejected token that begins a statement and is not followed by `=`;
/// `None` if there is no such name.
fn taken_for_a_flow(found: &ErrorContext<'_, '_>) -> Option<usize> {
    let at = found.error.index.checked_sub(1)?;
    let begins = at.checked_sub(1).and_then(|before| found.token_at(before));
    let is_first = matches!(
        begins,
        Some(Token::Let | Token::Semi | Token::Tel | Token::End)
    );
    let is_name = found.token_at(at) == Some(Token::Ident) && found.expects(Token::Eq);
    (is_first && is_name).then_some(at)
}

/// Reports that token `at` resembles one of the keywords `words`, and replaces it by the most similar one; `None` if
/// none is similar. `fix` creates the fix from its title.
fn replace_keyword(
    found: &ErrorContext<'_, '_>,
    at: usize,
    words: &[Token],
    fix: fn(String) -> Fix,
) -> Option<ForeignSyntax> {
    let written = found.source_text(at);
    let meant = nearest_keyword(found, at, words)?;
    let token = Token::from_spelling(&meant)?;
    let span = found.token_span(at);
    let message = format!("`{written}` is not a keyword");
    let diagnostic = Diagnostic::new(Code::RPI0001, message)
        .primary(span, format!("did you mean `{meant}`?"))
        .fix(fix(format!("write `{meant}`")).replace(span, meant));
    let mut edits = vec![found.replacement(at, &[token])];
    // After `then`, `end` is the target state, which the grammar expects as an identifier.
    if token == Token::Then && found.token_at(at + 1) == Some(Token::End) {
        edits.push(found.replacement(at + 1, &[Token::Ident]));
    }
    let repair = Repair::ReplaceTokens(edits);
    Some(ForeignSyntax { diagnostic, repair })
}

/// Returns the keyword among `words` that is most similar to the text of token `at`; `None` if none is similar.
fn nearest_keyword(found: &ErrorContext<'_, '_>, at: usize, words: &[Token]) -> Option<String> {
    let is_there = |token: &&Token| {
        let word = token.keyword();
        word.is_some_and(|word| word.is_in(found.cx.dialect) && word.text.len() >= MIN_LEN)
    };
    let near = words.iter().filter(is_there).filter_map(|t| t.spelling());
    rpi_diag::suggest(found.source_text(at), near)
}
