//! Operators called like nodes, `map<<+, n>>` and `Lustre::iplus(a, b)`, and calls of node parameters inside a generic
//! declaration.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::calls::arg_tuples;
use crate::check::calls::args;
use crate::check::calls::args::CallArgument;
use crate::check::calls::callable::Callable;
use crate::check::calls::predefined_ops::PredefinedOp;
use crate::check::exprs::expr;
use crate::check::exprs::ops;
use crate::check::signatures::header::Header;
use crate::ty::{Substitution, Ty};
use crate::typed::TypedKind;
use crate::typed::{self, ExprId};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::ast::StaticOp;
use rpi_syntax::ops::{BinaryOp, UnaryOp};
use std::rc::Rc;

/// Checks a call of an operator by its Lustre V6 name, such as `Lustre::iplus(a, b)`, and returns its typed expression.
/// `given` are the checked arguments.
pub(crate) fn call_predefined_op<'a>(
    cx: &mut Body<'_, 'a>,
    predef: &PredefinedOp,
    given: Vec<CallArgument<'a>>,
    span: Span,
) -> ExprId {
    let given = arg_tuples::flatten_tuple_args(cx, given);
    let (takes, gives) = predef.signature().unwrap_or((Vec::new(), Ty::Unknown));
    let mut sound = true;
    for (arg, ty) in given.iter().zip(&takes) {
        sound &= statement::expect_type(
            cx,
            arg.value,
            ty,
            &crate::check::diagnostics::report::ExpectationReason::Unexplained,
        );
    }
    match sound {
        true => call_operator(cx, predef.op, &given, span),
        false => cx.add(TypedKind::Error, gives, span),
    }
}

/// Checks the application of an operator to operands that have been checked, and returns its typed expression. Reports
/// a wrong number of operands.
pub(crate) fn call_operator<'a>(
    cx: &mut Body<'_, 'a>,
    op: StaticOp,
    given: &[CallArgument<'a>],
    span: Span,
) -> ExprId {
    let given = arg_tuples::flatten_tuple_args(cx, given.to_vec());
    let values: Vec<ExprId> = given.iter().map(|arg| arg.value).collect();
    match (op, &values[..]) {
        (StaticOp::Binary(op), [a, b]) => apply_binary(cx, op, *a, *b, span),
        (StaticOp::Unary(UnaryOp::Pre), [a]) => {
            cx.record_state(span);
            let ty = cx.ty_of(*a).clone();
            cx.add(
                TypedKind::Each(typed::ElementwiseOp::Pre, [*a].into()),
                ty,
                span,
            )
        }
        (StaticOp::Unary(op), [a]) => ops::unary_prim(cx, op, *a, span),
        (StaticOp::If, [c, a, b]) => {
            statement::expect_type(
                cx,
                *c,
                &Ty::Bool,
                &crate::check::diagnostics::report::ExpectationReason::Unexplained,
            );
            let ty = expr::common_type(
                cx,
                *a,
                *b,
                "both branches of an `if` must have the same type",
            );
            cx.add(
                TypedKind::Each(typed::ElementwiseOp::If, [*c, *a, *b].into()),
                ty,
                span,
            )
        }
        _ => {
            let name = Callable::Op(op).source_text();
            let diagnostic = Diagnostic::new(
                Code::RPI1010,
                format!(
                    "`{name}` does not take {}",
                    rpi_diag::with_noun(values.len(), "operand")
                ),
            )
            .primary(span, "wrong number of operands");
            cx.report_error_expr(diagnostic, span)
        }
    }
}

/// Checks a call of a static parameter that stands for a node and has no value yet. Only the arguments can be compared
/// with the declared ports. Returns an expression without a value that has the declared result type.
pub(crate) fn call_node_param<'a>(
    cx: &mut Body<'_, 'a>,
    header: &Rc<Header>,
    given: Vec<CallArgument<'a>>,
    span: Span,
) -> ExprId {
    if let Some(mut args) = args::match_args_to_ports(cx, header, &given, span) {
        args::check_arg_types(cx, header, &mut args, &mut Substitution::default());
    }
    cx.add(TypedKind::Error, header.result_type(), span)
}

fn apply_binary(cx: &mut Body<'_, '_>, op: BinaryOp, a: ExprId, b: ExprId, span: Span) -> ExprId {
    let each = match op {
        BinaryOp::Arrow => typed::ElementwiseOp::Arrow,
        BinaryOp::Coalesce => typed::ElementwiseOp::Coalesce,
        BinaryOp::Fby => {
            cx.record_state(span);
            let ty = cx.ty_of(b).clone();
            let before = cx.add(
                TypedKind::Each(typed::ElementwiseOp::Pre, [b].into()),
                ty,
                span,
            );
            return apply_binary(cx, BinaryOp::Arrow, a, before, span);
        }
        _ => return ops::binary_prim(cx, op, a, b, span),
    };
    let ty = expr::common_type(cx, a, b, "both sides must have the same type");
    cx.add(TypedKind::Each(each, [a, b].into()), ty, span)
}
