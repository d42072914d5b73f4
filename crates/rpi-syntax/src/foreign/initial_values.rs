//! Initial values of local variables: `var x: int := 0; let x = ...`.
//!
//! In other languages this initialises the variable. In RPI it would be a second equation of `x`.

use super::foreign_syntax;
use crate::context::ParseContext;
use crate::lexer::Lexeme;
use crate::token::Token;
use rpi_diag::{Diagnostic, Fix};
use std::collections::BTreeSet;
use std::ops::Range;

/// Reports initial values of locals that also have an equation, as in `var x: int := 0;`. Returns the tokens without
/// these values; [`None`] if there are none.
pub(crate) fn remove_initial_values(
    cx: &ParseContext<'_>,
    lexemes: &[Lexeme],
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<Vec<Lexeme>> {
    let is = |token| move |lexeme: &Lexeme| lexeme.token == token;
    let body = lexemes.iter().position(is(Token::Let))?;
    let locals = lexemes[..body].iter().position(is(Token::Var))?;
    let values = initial_values(cx, lexemes, locals..body);
    if values.is_empty() {
        return None;
    }
    let defined = defined_names(cx, &lexemes[body..]);
    let is_again =
        |(name, _): &(usize, Range<usize>)| defined.contains(source_text(cx, lexemes[*name]));
    let mut kept = lexemes.to_vec();
    for (name, value) in values.into_iter().filter(is_again).rev() {
        diagnostics.push(initial_value_diagnostic(cx, lexemes, name, value.clone()));
        kept.drain(value);
    }
    (kept.len() < lexemes.len()).then_some(kept)
}

/// Returns the initial values among the local declarations at the tokens `locals`: for each, the token index of the
/// name and the token range of its `:= 0`.
fn initial_values(
    cx: &ParseContext<'_>,
    lexemes: &[Lexeme],
    locals: Range<usize>,
) -> Vec<(usize, Range<usize>)> {
    let mut values = Vec::new();
    let mut start = locals.start + 1;
    for at in locals {
        if lexemes[at].token != Token::Semi {
            continue;
        }
        let is_sign =
            |i: &usize| lexemes[*i].token == Token::Eq && source_text(cx, lexemes[*i]) == ":=";
        let begins = lexemes[start].token == Token::Ident;
        if let Some(sign) = (start..at).find(is_sign).filter(|_| begins) {
            values.push((start, sign..at));
        }
        start = at + 1;
    }
    values
}

/// Returns the names on the left sides of the equations in the tokens of a body.
fn defined_names<'t>(cx: &ParseContext<'t>, body: &[Lexeme]) -> BTreeSet<&'t str> {
    use Token::{Eq, Ident, Let, Semi, Tel};
    let is_equation = |w: &&[Lexeme]| {
        matches!(w[0].token, Let | Semi | Tel) && w[1].token == Ident && w[2].token == Eq
    };
    let equations = body.windows(3).filter(is_equation);
    equations.map(|w| source_text(cx, w[1])).collect()
}

fn initial_value_diagnostic(
    cx: &ParseContext<'_>,
    lexemes: &[Lexeme],
    name: usize,
    value: Range<usize>,
) -> Diagnostic {
    let (sign, last) = (lexemes[value.start], lexemes[value.end - 1]);
    let span = cx.span(sign.start, last.end);
    cx.suppress_foreign_operators(span);
    let gap = cx.span(lexemes[value.start - 1].end, last.end);
    let name = source_text(cx, lexemes[name]);
    let first = cx.slice(lexemes[value.start + 1].start, last.end);
    foreign_syntax("a declaration cannot initialise a flow")
        .primary(span, "its equation defines it in every cycle")
        .help(format!(
            "`{name} = {first} -> ...;` is {first} in the first cycle"
        ))
        .fix(Fix::maybe("delete the initial value").replace(gap, ""))
}

fn source_text<'t>(cx: &ParseContext<'t>, lexeme: Lexeme) -> &'t str {
    cx.slice(lexeme.start, lexeme.end)
}
