//! Grammar actions for the steps of tasks.
//!
//! In the functions, `l` and `r` are the byte offsets of the beginning and end of the node.

use crate::ast::*;
use crate::context::ParseContext;

pub(crate) fn run(
    label: Option<Ident>,
    callee: Callee,
    args: Vec<Arg>,
    branches: Vec<Branch>,
) -> Box<StepKind> {
    Box::new(StepKind::Run(Box::new(Run {
        label,
        callee,
        args,
        branches,
    })))
}

pub(crate) fn step(cx: &ParseContext<'_>, l: u32, kind: StepKind, r: u32) -> Box<Step> {
    Box::new(Step {
        doc: cx.doc(l),
        kind,
        span: cx.span_to_token(l, r),
    })
}

pub(crate) fn branch(
    cx: &ParseContext<'_>,
    l: u32,
    on: Vec<Ident>,
    then: Ident,
    r: u32,
) -> Box<Branch> {
    Box::new(Branch {
        results: on.into_iter().map(on_result).collect(),
        next: next(then),
        span: cx.span(l, r),
    })
}

fn on_result(word: Ident) -> ResultPattern {
    match word.name.as_str() {
        "fail" => ResultPattern::Fail(word.span),
        "any" => ResultPattern::Any(word.span),
        _ => ResultPattern::Named(word),
    }
}

fn next(word: Ident) -> NextStep {
    match word.name.as_str() {
        "end" => NextStep::End(word.span),
        _ => NextStep::Step(word),
    }
}
