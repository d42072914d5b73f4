//! `var x: int := 0; let x = ...`: what elsewhere is the first value of a variable, and here would be a second equation.

use super::habit;
use crate::context::Context;
use crate::lexer::Lexeme;
use crate::token::Token;
use rpi_diag::{Finding, Fix};
use std::collections::BTreeSet;
use std::ops::Range;

/// The tokens without such values, which are reported. [`None`] if there are none.
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

/// Each name with its `:= 0`, in text order.
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

/// The names that equations of a body define.
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
    habit("a declaration gives a flow no first value")
        .at(span, "its equation says what it is in every cycle")
        .help(format!(
            "`{name} = {first} -> ...;` is {first} in the first cycle only"
        ))
        .fix(Fix::maybe("delete the first value").replace(gap, ""))
}

fn written<'t>(cx: &Context<'t>, lexeme: Lexeme) -> &'t str {
    cx.slice(lexeme.start, lexeme.end)
}
