//! Grammar actions for statements and automata.
//!
//! In the functions, `l` and `r` are the byte offsets of the beginning and end of the node.

use crate::ast::*;
use crate::context::ParseContext;

pub(crate) fn equation(targets: Vec<Target>, value: Expr) -> StatementKind {
    StatementKind::Equation(Box::new(Equation { targets, value }))
}

pub(crate) fn statement(cx: &ParseContext<'_>, l: u32, kind: StatementKind, r: u32) -> Statement {
    let span = match kind {
        StatementKind::Fragment(_) | StatementKind::Automaton(_) => cx.span_to_token(l, r),
        _ => cx.span(l, r),
    };
    Statement {
        doc: cx.doc(l),
        kind,
        span,
    }
}

pub(crate) fn extend_target(mut target: Target, access: Access, r: u32) -> Target {
    target.path.push(access);
    target.span.end = r;
    target
}

#[allow(
    clippy::too_many_arguments,
    reason = "one argument per part of the production"
)]
pub(crate) fn state(
    cx: &ParseContext<'_>,
    l: u32,
    initial: bool,
    name: Ident,
    unless: Vec<Transition>,
    body: Option<Box<Body>>,
    until: Vec<Transition>,
    r: u32,
) -> Box<State> {
    Box::new(State {
        doc: cx.doc(l),
        is_initial: initial,
        name,
        unless,
        body: body.map_or_else(Body::default, |body| *body),
        until,
        span: cx.span_to_token(l, r),
    })
}

pub(crate) fn transition(
    cx: &ParseContext<'_>,
    l: u32,
    condition: Option<Expr>,
    resumes: bool,
    target: Ident,
    r: u32,
) -> Box<Transition> {
    Box::new(Transition {
        condition,
        resumes,
        target,
        span: cx.span(l, r),
    })
}
