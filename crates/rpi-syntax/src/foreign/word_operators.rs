//! Operators spelt as words or in upper case in other languages: `x is 3`, `NOT c`, `prev x`.

use super::{ForeignSyntax, Repair, foreign_syntax};
use crate::syntax_errors::ErrorContext;
use crate::token::Token;
use rpi_diag::{Code, Diagnostic, Fix};

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
pub(super) fn infix_word(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_reserved = |token: Token| {
        token
            .keyword()
            .is_none_or(|k| k.is_reserved_in(found.cx.dialect))
    };
    let is_word = found
        .token_at(at)
        .is_some_and(|token| token == Token::Ident || !is_reserved(token));
    let token = lookup(INFIX, found.source_text(at)).filter(|_| is_word)?;
    if !found.expects(token) || found.lacks_semi() || !begins_operand(found, at + 1) {
        return None;
    }
    Some(replace_operator(found, at, token))
}

/// Recognises a prefix operator that the grammar took for the name of a flow: `NOT c`, `prev x`.
pub(super) fn prefix_word(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index.checked_sub(1)?;
    let is_word = found.token_at(at) == Some(Token::Ident)
        && !found.cx.guessed_names.declares(found.source_text(at));
    if !is_word || !is_operand_position(found, at) || !begins_operand(found, at + 1) {
        return None;
    }
    let word = found.source_text(at);
    let token = lookup(PREFIX, word).or_else(|| misspelt_prefix(found, word))?;
    Some(replace_operator(found, at, token))
}

/// Returns the prefix operator (`not`, `pre`, `last` or `current`) of which `word` is a misspelling; `None` if there is
/// none.
fn misspelt_prefix(found: &ErrorContext<'_, '_>, word: &str) -> Option<Token> {
    const WORDS: [Token; 4] = [Token::Not, Token::Pre, Token::Last, Token::Current];
    let is_there = |token: &&Token| token.keyword().is_some_and(|k| k.is_in(found.cx.dialect));
    let words = WORDS
        .iter()
        .filter(is_there)
        .filter_map(|token| token.spelling());
    let meant = (word.len() > 2).then(|| rpi_diag::suggest(word, words))??;
    Token::from_spelling(&meant)
}

/// Returns the token that a table assigns to a word, ignoring case; `None` if no row lists the word.
fn lookup(table: &[(&[&str], Token)], word: &str) -> Option<Token> {
    let word = word.to_ascii_lowercase();
    let row = table.iter().find(|(words, _)| words.contains(&&*word));
    row.map(|(_, token)| *token)
}

/// Reports that the word at token `at` means the operator `token`. The repair replaces the word by the operator.
fn replace_operator(found: &ErrorContext<'_, '_>, at: usize, token: Token) -> ForeignSyntax {
    let meant = token.spelling().unwrap_or_default();
    let span = found.token_span(at);
    let word = found.source_text(at);
    let message = format!("`{word}` is not an operator");
    let diagnostic = match word.eq_ignore_ascii_case(meant) {
        true => foreign_syntax(format!("`{meant}` is written in lower case"))
            .primary(span, format!("expected `{meant}`")),
        false => Diagnostic::new(Code::RPI0001, message)
            .primary(span, format!("did you mean `{meant}`?")),
    };
    ForeignSyntax {
        diagnostic: diagnostic.fix(Fix::maybe(format!("write `{meant}`")).replace(span, meant)),
        repair: Repair::ReplaceTokens(vec![found.replacement(at, &[token])]),
    }
}

/// Returns whether an operand is expected at token `at`, because an operator, keyword or opening bracket precedes it.
pub(super) fn is_operand_position(found: &ErrorContext<'_, '_>, at: usize) -> bool {
    use Token::{
        And, Arrow, Assert, Coalesce, Comma, Div, Else, Eq, Ge, Gt, If, Implies, LBracket, LParen,
        Le, Lt, Minus, Mod, Ne, Not, Or, Plus, Pre, Slash, Star, Then, When, With, Xor,
    };
    let before = at.checked_sub(1).and_then(|at| found.token_at(at));
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

/// Returns whether an operand begins at token `at`, on the same line as the token before it.
pub(super) fn begins_operand(found: &ErrorContext<'_, '_>, at: usize) -> bool {
    use Token::{False, Ident, Int, LParen, Minus, Not, Path, Pre, Real, True};
    let begins = matches!(
        found.token_at(at),
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
pub(super) fn bool_conversion(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_value = found.token_at(at) == Some(Token::BoolType) && found.expects(Token::Int);
    if !is_value || !is_operand_position(found, at) {
        return None;
    }
    let diagnostic = foreign_syntax("a number cannot be converted to `bool`; compare it")
        .primary(found.token_span(at), "not a conversion")
        .help("`x <> 0` is true when `x` is not 0");
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveErrorPhrase,
    })
}

/// Recognises a count of the cycles in which a condition held: `3 times c`.
pub(super) fn counted_condition(found: &ErrorContext<'_, '_>) -> Option<ForeignSyntax> {
    let at = found.error.index;
    let is_count = matches!(found.token_before(), Some(Token::Int | Token::Ident));
    if found.source_text(at) != "times" || found.in_task() || !is_count {
        return None;
    }
    let diagnostic = foreign_syntax("count the cycles of a condition with an equation")
        .primary(found.token_span(at), "`times` repeats the steps of a task")
        .help("`k = if c then 1 else 0; n = k -> pre n + k;`, then `n = 3`");
    Some(ForeignSyntax {
        diagnostic,
        repair: Repair::RemoveErrorPhrase,
    })
}
