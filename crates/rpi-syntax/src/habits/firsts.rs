//! Initial values of local variables: `var x: int := 0; let x = ...`.
//!
//! In other languages this initialises the variable. In RPI it would be a second equation of `x`.

use super::habit;
use crate::context::Context;
use crate::lexer::Lexeme;
use crate::token::Token;
use rpi_diag::{Finding, Fix};
use std::collections::BTreeSet;
use std::ops::Range;

/// Reports initial values of locals that also have an equation. Returns the tokens without these values, or [`None`].
pub(crate) fn without_first_values(
    cx: &Context<'_>,
    lexemes: &[Lexeme],
    findings: &mut Vec<Finding>,
) -> Option<Vec<Lexeme>> {
    let is = |token| move |lexeme: &Lexeme| lexeme.token == token;
    let body = lexemes.iter().position(is(Token::Let))?;
    let locals = lexemes[..body].iter().position(is(Token::Var))?;
    let values = values(cx, lexemes, locals..body);
    if values.is_empty() {
        return None;
    }
    let defined = defined(cx, &lexemes[body..]);
    let is_again =
        |(name, _): &(usize, Range<usize>)| defined.contains(written(cx, lexemes[*name]));
    let mut kept = lexemes.to_vec();
    for (name, value) in values.into_iter().filter(is_again).rev() {
        findings.push(finding(cx, lexemes, name, value.clone()));
        kept.drain(value);
    }
    (kept.len() < lexemes.len()).then_some(kept)
}

/// Returns each local's name with the token range of its `:= 0`, in text order.
fn values(
    cx: &Context<'_>,
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
            |i: &usize| lexemes[*i].token == Token::Eq && written(cx, lexemes[*i]) == ":=";
        let begins = lexemes[start].token == Token::Ident;
        if let Some(sign) = (start..at).find(is_sign).filter(|_| begins) {
            values.push((start, sign..at));
        }
        start = at + 1;
    }
    values
}

/// Returns the names that the equations of a body define.
fn defined<'t>(cx: &Context<'t>, body: &[Lexeme]) -> BTreeSet<&'t str> {
    use Token::{Eq, Ident, Let, Semi, Tel};
    let is_equation = |w: &&[Lexeme]| {
        matches!(w[0].token, Let | Semi | Tel) && w[1].token == Ident && w[2].token == Eq
    };
    let equations = body.windows(3).filter(is_equation);
    equations.map(|w| written(cx, w[1])).collect()
}

fn finding(cx: &Context<'_>, lexemes: &[Lexeme], name: usize, value: Range<usize>) -> Finding {
    let (sign, last) = (lexemes[value.start], lexemes[value.end - 1]);
    let span = cx.span(sign.start, last.end);
    cx.swallow_signs(span);
    let gap = cx.span(lexemes[value.start - 1].end, last.end);
    let name = written(cx, lexemes[name]);
    let first = cx.slice(lexemes[value.start + 1].start, last.end);
    habit("a declaration cannot initialise a flow")
        .at(span, "its equation defines it in every cycle")
        .help(format!(
            "`{name} = {first} -> ...;` is {first} in the first cycle"
        ))
        .fix(Fix::maybe("delete the initial value").replace(gap, ""))
}

fn written<'t>(cx: &Context<'t>, lexeme: Lexeme) -> &'t str {
    cx.slice(lexeme.start, lexeme.end)
}
