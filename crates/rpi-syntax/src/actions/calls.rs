//! Grammar actions for calls and their static arguments.
//!
//! In the functions, `l` and `r` are the byte offsets of the beginning and end of the node.

use super::exprs;
use super::types;
use crate::ast::*;
use crate::context::ParseContext;

pub(crate) fn call(callee: Callee, activation: Activation, args: Vec<Arg>) -> Box<Call> {
    Box::new(Call {
        callee,
        activation,
        args,
    })
}

pub(crate) fn activate(
    every: Expr,
    (default, restart): (Option<Expr>, Option<Expr>),
) -> Activation {
    Activation::Activate {
        every,
        restart,
        default,
    }
}

/// Builds a conversion to a machine integer, `int8 x` or `sint@<25> x`, as a call. `l` is the byte offset of its first
/// character.
pub(crate) fn conversion(
    cx: &ParseContext<'_>,
    l: u32,
    to: Ident,
    bits: Vec<StaticArg>,
    value: Expr,
) -> Expr {
    let r = value.span.end;
    let value = match value.kind {
        ExprKind::Paren(inner) => *inner,
        _ => value,
    };
    let callee = callee(cx, to.span.start, to.clone(), bits, to.span.end);
    let args = vec![Arg { name: None, value }];
    call_expr(cx, l, call(*callee, Activation::Always, args), r)
}

/// Builds the expression `any { x: T | c }` of Kind 2, a value that satisfies a condition. `p` is the byte offset of
/// its type.
pub(crate) fn any_value(
    cx: &ParseContext<'_>,
    name: Ident,
    p: u32,
    refined: Box<RefinementType>,
    r: u32,
) -> Expr {
    let l = name.span.start;
    let ty = types::ty(cx, p, TypeKind::Refinement(refined), r);
    let of = *static_arg(cx, p, None, StaticValue::Type(ty), r);
    let callee = callee(cx, l, name, vec![of], r);
    let call = call(*callee, Activation::Always, Vec::new());
    call_expr(cx, l, call, r)
}

/// Builds a static argument from a number literal among type arguments, as in `uint<32>`. `l..r` is its byte range.
pub(crate) fn static_number(cx: &ParseContext<'_>, l: u32, r: u32) -> Box<StaticArg> {
    let number = exprs::number(cx, l, r);
    let value = exprs::expr(cx, l, ExprKind::Number(number), r);
    static_arg(cx, l, None, StaticValue::Expr(value), r)
}

pub(crate) fn call_expr(cx: &ParseContext<'_>, l: u32, call: Box<Call>, r: u32) -> Expr {
    exprs::expr(cx, l, ExprKind::Call(call), r)
}

pub(crate) fn callee(
    cx: &ParseContext<'_>,
    l: u32,
    name: Ident,
    statics: Vec<StaticArg>,
    r: u32,
) -> Box<Callee> {
    let span = cx.span(l, r);
    Box::new(Callee {
        name,
        statics,
        span,
    })
}

pub(crate) fn static_arg(
    cx: &ParseContext<'_>,
    l: u32,
    name: Option<Ident>,
    value: StaticValue,
    r: u32,
) -> Box<StaticArg> {
    let span = cx.span(l, r);
    Box::new(StaticArg { name, value, span })
}
