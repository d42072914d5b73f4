//! Operators spelt as words or in upper case in other languages: `x is 3`, `NOT c`, `prev x`.

use super::{Habit, Mend, habit};
use crate::explain::Found;
use crate::token::Token;
use rpi_diag::{Code, Finding, Fix};

/// Binary operators of other languages, in lower case, with the equivalent RPI tokens.
const INFIX: &[(&[&str], Token)] = &[
    (&["and", "andalso", "und", "et"], Token::And),
    (&["or", "orelse", "oder"], Token::Or),
    (&["xor"], Token::Xor),
    (&["mod", "modulo", "rem"], Token::Mod),
    (&["div"], Token::Div),
    (&["is", "eq", "equals", "equal"], Token::Eq),
    (&["isnt", "ne", "neq", "unequal"], Token::Ne),
    (&["lt"], Token::Lt),
    (&["le", "leq"], Token::Le),
    (&["gt"], Token::Gt),
    (&["ge", "geq"], Token::Ge),
    (&["implies"], Token::Implies),
    (&["default", "orelse", "otherwise"], Token::Coalesce),
    (&["then"], Token::Then),
    (&["else"], Token::Else),
    (&["when"], Token::When),
    (&["fby"], Token::Fby),
];

/// Prefix operators of other languages, in lower case, with the equivalent RPI tokens.
const PREFIX: &[(&[&str], Token)] = &[
    (&["not", "nicht"], Token::Not),
    (&["pre", "prev", "previous", "old"], Token::Pre),
    (&["last"], Token::Last),
    (&["current"], Token::Current),
    (&["int", "integer"], Token::IntType),
    (&["real", "float", "double"], Token::RealType),
];

/// Recognises a binary operator spelt as a word: `x is 3`, `c OR d`.
pub(super) fn infix(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let is_reserved = |token: Token| {
        token
            .keyword()
            .is_none_or(|k| k.is_reserved_in(found.cx.mode))
    };
    let is_word = found
        .token(at)
        .is_some_and(|token| token == Token::Ident || !is_reserved(token));
    let token = look(INFIX, found.written(at)).filter(|_| is_word)?;
    if !found.expects(token) || found.lacks_semi() || !begins_operand(found, at + 1) {
        return None;
    }
    Some(written(found, at, token))
}

/// Recognises a prefix operator that the grammar took for the name of a flow: `NOT c`, `prev x`.
pub(super) fn prefix(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at.checked_sub(1)?;
    let is_word =
        found.token(at) == Some(Token::Ident) && !found.cx.seeming.declares(found.written(at));
    if !is_word || !stands_for_operand(found, at) || !begins_operand(found, at + 1) {
        return None;
    }
    let word = found.written(at);
    let token = look(PREFIX, word).or_else(|| near(found, word))?;
    Some(written(found, at, token))
}

/// Returns the prefix operator that `word` is a misspelling of.
fn near(found: &Found<'_, '_>, word: &str) -> Option<Token> {
    const WORDS: [Token; 4] = [Token::Not, Token::Pre, Token::Last, Token::Current];
    let is_there = |token: &&Token| token.keyword().is_some_and(|k| k.is_in(found.cx.mode));
    let words = WORDS
        .iter()
        .filter(is_there)
        .filter_map(|token| token.spelling());
    let meant = (word.len() > 2).then(|| rpi_diag::suggest(word, words))??;
    Token::of_spelling(&meant)
}

/// Looks up a word in a table, ignoring case.
fn look(table: &[(&[&str], Token)], word: &str) -> Option<Token> {
    let word = word.to_ascii_lowercase();
    let row = table.iter().find(|(words, _)| words.contains(&&*word));
    row.map(|(_, token)| *token)
}

/// Reports that the word at token `at` means the operator `token`, and replaces it.
fn written(found: &Found<'_, '_>, at: usize, token: Token) -> Habit {
    let meant = token.spelling().unwrap_or_default();
    let span = found.span_at(at);
    let word = found.written(at);
    let message = format!("`{word}` is not an operator");
    let finding = match word.eq_ignore_ascii_case(meant) {
        true => habit(format!("`{meant}` is written in lower case"))
            .at(span, format!("expected `{meant}`")),
        false => Finding::new(Code::RPI0001, message).at(span, format!("did you mean `{meant}`?")),
    };
    Habit {
        finding: finding.fix(Fix::maybe(format!("write `{meant}`")).replace(span, meant)),
        mend: Mend::Tokens(vec![found.instead(at, &[token])]),
    }
}

/// Returns whether token `at` is in the position of an operand: after an operator or an opening bracket.
pub(super) fn stands_for_operand(found: &Found<'_, '_>, at: usize) -> bool {
    use Token::{
        And, Arrow, Assert, Coalesce, Comma, Div, Else, Eq, Ge, Gt, If, Implies, LBracket, LParen,
        Le, Lt, Minus, Mod, Ne, Not, Or, Plus, Pre, Slash, Star, Then, When, With, Xor,
    };
    let before = at.checked_sub(1).and_then(|at| found.token(at));
    matches!(
        before,
        Some(
            And | Arrow
                | Assert
                | Comma
                | Coalesce
                | Div
                | Else
                | Eq
                | Ge
                | Gt
                | If
                | Implies
                | LBracket
                | LParen
                | Le
                | Lt
                | Minus
                | Mod
                | Ne
                | Not
                | Or
                | Plus
                | Pre
                | Slash
                | Star
                | Then
                | When
                | With
                | Xor
        )
    )
}

/// Returns whether an operand begins at token `at`, on the same line as the token before.
pub(super) fn begins_operand(found: &Found<'_, '_>, at: usize) -> bool {
    use Token::{False, Ident, Int, LParen, Minus, Not, Path, Pre, Real, True};
    let begins = matches!(
        found.token(at),
        Some(False | Ident | Int | LParen | Minus | Not | Path | Pre | Real | True)
    );
    begins
        && at > 0
        && !found
            .cx
            .slice(found.lexemes[at - 1].end, found.lexemes[at].start)
            .contains('\n')
}

/// Recognises a conversion to `bool`: `bool(x)`.
pub(super) fn truth(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let is_value = found.token(at) == Some(Token::BoolType) && found.expects(Token::Int);
    if !is_value || !stands_for_operand(found, at) {
        return None;
    }
    let finding = habit("a number cannot be converted to `bool`; compare it")
        .at(found.span_at(at), "not a conversion")
        .help("`x <> 0` is true when `x` is not 0");
    Some(Habit {
        finding,
        mend: Mend::Usual,
    })
}

/// Recognises a counted condition: `3 times c`.
pub(super) fn times(found: &Found<'_, '_>) -> Option<Habit> {
    let at = found.fault.at;
    let is_count = matches!(found.token_before(), Some(Token::Int | Token::Ident));
    if found.written(at) != "times" || found.in_task() || !is_count {
        return None;
    }
    let finding = habit("count the cycles of a condition with an equation")
        .at(found.span_at(at), "`times` repeats the steps of a task")
        .help("`k = if c then 1 else 0; n = k -> pre n + k;`, then `n = 3`");
    Some(Habit {
        finding,
        mend: Mend::Usual,
    })
}
