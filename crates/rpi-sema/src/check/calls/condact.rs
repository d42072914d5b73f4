//! `condact<<node, default>>(c, x, ...)` of Lustre V6: the node runs when `c` is true. The output is held between
//! activations, and is `default` before the first one.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::calls::arg_tuples;
use crate::check::calls::args;
use crate::check::calls::args::CallArgument;
use crate::check::calls::call;
use crate::check::calls::callable::Callable;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::exprs::expr;
use crate::check::signatures::callable_args;
use crate::ty::Ty;
use crate::typed::ExprId;
use crate::typed::{Activation, ElementwiseOp, TypedKind};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::ast::{Call, Expr, StaticValue};

/// Checks a call of `condact` with static arguments, `condact<<node, default>>(condition, arguments)`, and returns its
/// typed expression.
pub(crate) fn condact_call<'a>(cx: &mut Body<'_, 'a>, call: &'a Call, span: Span) -> ExprId {
    let given = args::check_args(cx, &call.args);
    let mut given = flatten_first_arg(cx, given).into_iter();
    let (Some(every), [callee, default]) = (given.next(), &call.callee.statics[..]) else {
        let diagnostic = Diagnostic::new(Code::RPI1010, "missing arguments of `condact`")
            .primary(span, "invalid arguments")
            .help("write `condact<<node, default>>(condition, arguments)`");
        return cx.report_error_expr(diagnostic, span);
    };
    let StaticValue::Expr(default) = &default.value else {
        let diagnostic = Diagnostic::new(Code::RPI1010, "a value is expected here")
            .primary(default.span, "not a value");
        return cx.report_error_expr(diagnostic, span);
    };
    let Some(callable) = callable_args::static_callee(cx, callee) else {
        return cx.error_expr(span);
    };
    cx.record_state(span);
    statement::expect_type(cx, every.value, &Ty::Bool, &ExpectationReason::Unexplained);
    let default = expr::check_expr(cx, default);
    let rest = given.collect();
    match callable {
        Callable::Unit(..) => {
            let activation = Activation::Condact {
                every: every.value,
                default: Some(default),
                restart: None,
            };
            call::call_callable(cx, &callable, rest, activation, span)
        }
        _ => condact_of_operator(cx, &callable, rest, [every.value, default], span),
    }
}

/// Replaces the first argument by its elements if it is a tuple, because the condition of `condact` may be the first
/// output of a call.
fn flatten_first_arg<'a>(
    cx: &mut Body<'_, 'a>,
    mut given: Vec<CallArgument<'a>>,
) -> Vec<CallArgument<'a>> {
    let rest = given.split_off(given.len().min(1));
    arg_tuples::flatten_tuple_args(cx, given)
        .into_iter()
        .chain(rest)
        .collect()
}

/// Checks the default of a conditionally active call: the value of its output before the first activation. After that,
/// the output is held while the call is not active.
pub(crate) fn check_condact_default<'a>(cx: &mut Body<'_, 'a>, default: &'a Expr) -> ExprId {
    cx.record_state(default.span);
    expr::check_expr(cx, default)
}

/// Checks `condact` of an operator. The operator has no state of its own, so that its value is held while the condition
/// is false. `every` is the condition and `default` is the value before the condition is true for the first time.
fn condact_of_operator<'a>(
    cx: &mut Body<'_, 'a>,
    callable: &Callable,
    given: Vec<CallArgument<'a>>,
    [every, default]: [ExprId; 2],
    span: Span,
) -> ExprId {
    let value = call::call_callable(cx, callable, given, Activation::Always, span);
    let ty = cx.ty_of(value).clone();
    statement::expect_type(cx, default, &ty, &ExpectationReason::Unexplained);
    let none = cx.add(TypedKind::None, ty.clone(), span);
    let there = TypedKind::Each(ElementwiseOp::If, [every, value, none].into());
    let there = cx.add(there, ty.clone(), span);
    cx.add(
        TypedKind::Each(ElementwiseOp::Hold, [there, default].into()),
        ty,
        span,
    )
}
