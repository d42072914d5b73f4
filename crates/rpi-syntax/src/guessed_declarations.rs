//! Names that text with syntax errors seems to declare, so that their uses cause no follow-up errors.

use crate::ast::{DeclaredKind, DeclaredName, Ident};
use crate::context::ParseContext;
use crate::lexer::Lexeme;
use crate::token::Token;

/// Returns the names that a statement, declaration or step with a syntax error seems to define: targets of an equation,
/// ports, a label, a result. `phrase` holds its tokens.
pub(crate) fn names_of_phrase(cx: &ParseContext<'_>, phrase: &[Lexeme]) -> Vec<Ident> {
    use Token::{Automaton, Fail, Finish, Fragment, State, Yield};
    let head = phrase.first().map(|lexeme| lexeme.token);
    let mut names = match head {
        Some(Finish | Yield | Fail | Fragment | State) => first_name(cx, &phrase[1..]),
        Some(Automaton) => Vec::new(),
        _ => names_before_definition(cx, phrase),
    };
    if head != Some(Fragment) {
        names.extend(inner_targets(cx, phrase));
    }
    names
}

/// Returns the targets of the equations inside a statement with a syntax error, such as those in states of an automaton
/// or in cases of other languages. `phrase` holds the tokens of the statement.
pub(crate) fn inner_targets(
    cx: &ParseContext<'_>,
    phrase: &[Lexeme],
) -> impl Iterator<Item = Ident> {
    use Token::{Colon, Eq, Ident, Let, Semi};
    let colon = phrase.get(1).filter(|second| second.token == Colon);
    let is_equation = move |w: &&[Lexeme]| {
        let [before, name, after] = [w[0], w[1], w[2]].map(|lexeme| lexeme.token);
        // In `a: Pose = ...` the upper-case name is a type, not a target.
        let is_type = colon.is_some_and(|colon| colon.start == w[0].start)
            && cx
                .slice(w[1].start, w[1].end)
                .starts_with(char::is_uppercase);
        matches!(before, Let | Semi | Colon) && name == Ident && after == Eq && !is_type
    };
    let equations = phrase.windows(3).filter(is_equation);
    equations.map(|w| cx.ident(w[1].start, w[1].end))
}

/// Returns the names that a declaration with a syntax error seems to declare. `lexemes` are its tokens.
pub(crate) fn names_of_item(cx: &ParseContext<'_>, lexemes: &[Lexeme]) -> Vec<Ident> {
    match lexemes.first().map(|lexeme| lexeme.token) {
        Some(Token::Const | Token::Datatype | Token::Type) => {
            let phrases = lexemes[1..].split(|lexeme| lexeme.token == Token::Semi);
            phrases
                .flat_map(|phrase| names_before_definition(cx, phrase))
                .collect()
        }
        Some(Token::Frame) => leading_names(cx, &lexemes[1..]),
        _ => first_name(cx, lexemes),
    }
}

/// Returns the constructors that a `datatype` with a syntax error seems to declare. Constructors with fields are
/// callable, others are constants.
pub(crate) fn datatype_constructors(
    cx: &ParseContext<'_>,
    lexemes: &[Lexeme],
) -> Vec<DeclaredName> {
    use Token::{Bar, Case, Datatype, Eq, Ident, LParen};
    let is_datatype = lexemes
        .first()
        .is_some_and(|lexeme| lexeme.token == Datatype);
    let begins = |w: &&[Lexeme]| {
        matches!(w[0].token, Bar | Case | Eq | Ident) && w[1].token == Ident && is_datatype
    };
    let names = lexemes.windows(3).skip(1).filter(begins);
    let declared = names.map(|w| DeclaredName {
        kind: match w[2].token {
            LParen => DeclaredKind::Callable,
            _ => DeclaredKind::Const,
        },
        name: cx.ident(w[1].start, w[1].end),
    });
    declared.collect()
}

/// Returns the names before the first `=` or `:` in the tokens `phrase`, without fields and indices. Without `=` and
/// `:`, returns the names separated by commas at the start.
fn names_before_definition(cx: &ParseContext<'_>, phrase: &[Lexeme]) -> Vec<Ident> {
    let defines = |lexeme: &Lexeme| matches!(lexeme.token, Token::Eq | Token::Colon);
    match phrase.iter().position(defines) {
        Some(end) => target_names(cx, &phrase[..end]),
        None => leading_names(cx, phrase),
    }
}

fn target_names(cx: &ParseContext<'_>, lexemes: &[Lexeme]) -> Vec<Ident> {
    let mut names = Vec::new();
    let mut before = Token::Comma;
    for lexeme in lexemes {
        if lexeme.token == Token::Ident && matches!(before, Token::Comma | Token::LParen) {
            names.push(cx.ident(lexeme.start, lexeme.end));
        }
        before = lexeme.token;
    }
    names
}

fn first_name(cx: &ParseContext<'_>, lexemes: &[Lexeme]) -> Vec<Ident> {
    let is_name = |lexeme: &&Lexeme| matches!(lexeme.token, Token::Ident | Token::Path);
    let name = lexemes.iter().take(4).find(is_name);
    name.map(|lexeme| cx.ident(lexeme.start, lexeme.end))
        .into_iter()
        .collect()
}

fn leading_names(cx: &ParseContext<'_>, lexemes: &[Lexeme]) -> Vec<Ident> {
    let in_row = |lexeme: &&Lexeme| matches!(lexeme.token, Token::Ident | Token::Comma);
    let row: Vec<Lexeme> = lexemes.iter().take_while(in_row).copied().collect();
    target_names(cx, &row)
}
