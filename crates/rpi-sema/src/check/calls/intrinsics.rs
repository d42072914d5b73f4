//! Predeclared operators in call syntax. A declaration of the same name hides them.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::calls::args;
use crate::check::calls::args::CallArgument;
use crate::check::calls::call;
use crate::check::calls::prim;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::exprs::expr;
use crate::check::exprs::proof_only;
use crate::check::exprs::spatial_ops;
use crate::check::exprs::spatial_ops::SpatialOp;
use crate::check::signatures::static_args;
use crate::check::types::exact_time;
use crate::check::types::machine_int;
use crate::ty::{MachineInt, Ty};
use crate::typed::ExprId;
use crate::typed::{Activation, ElementwiseOp, TypedKind};
use crate::units::{Dimension, Ratio};
use rpi_diag::with_noun;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_net::prim;
use rpi_syntax::ast::{self, ExprKind};

/// Predeclared operator in call syntax whose arguments have rules of their own.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Intrinsic {
    /// `present(x)`: whether a flow is present in this cycle.
    Present,
    /// `hold(x, init)`: the latest present value; `init` before the first one.
    Hold,
    /// `condact(c, f(x), d)`: the value of `f(x)` in cycles in which `c` holds, else the previous value; `d` before `c`
    /// holds for the first time.
    Condact,
    /// `sqrt(x)`: square root of the value and of its dimension.
    Sqrt,
    /// `any<<t>>()`, or `any@<t>` of Kind 2: a nondeterministic value of a type.
    Any,
    /// `choose { x: t | c }` of Kind 2: a nondeterministic value that is always the same for the same arguments.
    Choose,
    /// `(int8 x)` of Kind 2: conversion to the machine integer type with this name.
    Machine(&'static str),
    /// `time(x)`: conversion of seconds to a time in whole ticks, rounded up.
    Time,
    /// `norm(v)` and the other operators on vectors, rotations and poses.
    Spatial(SpatialOp),
}

/// All predeclared operators in call syntax.
pub(crate) const INTRINSICS: &[Intrinsic] = &[
    Intrinsic::Present,
    Intrinsic::Hold,
    Intrinsic::Condact,
    Intrinsic::Sqrt,
    Intrinsic::Any,
    Intrinsic::Choose,
    Intrinsic::Time,
    Intrinsic::Machine("int8"),
    Intrinsic::Machine("int16"),
    Intrinsic::Machine("int32"),
    Intrinsic::Machine("int64"),
    Intrinsic::Machine("uint8"),
    Intrinsic::Machine("uint16"),
    Intrinsic::Machine("uint32"),
    Intrinsic::Machine("uint64"),
    Intrinsic::Machine("sint"),
    Intrinsic::Machine("uint"),
    Intrinsic::Spatial(SpatialOp::Vector),
    Intrinsic::Spatial(SpatialOp::Dot),
    Intrinsic::Spatial(SpatialOp::Cross),
    Intrinsic::Spatial(SpatialOp::Norm),
    Intrinsic::Spatial(SpatialOp::Inverse),
];

impl Intrinsic {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Intrinsic::Present => "present",
            Intrinsic::Hold => "hold",
            Intrinsic::Condact => "condact",
            Intrinsic::Sqrt => "sqrt",
            Intrinsic::Any => "any",
            Intrinsic::Choose => "choose",
            Intrinsic::Machine(name) => name,
            Intrinsic::Time => "time",
            Intrinsic::Spatial(op) => op.name(),
        }
    }
}

impl Intrinsic {
    /// Returns the syntax of a call and a description of the result, for help texts.
    fn usage(self) -> &'static str {
        match self {
            Intrinsic::Present => "`present(x)`: whether `x` is present",
            Intrinsic::Hold => {
                "`hold(x, init)`: the latest value of `x`, `init` before the first one"
            }
            Intrinsic::Condact => "`condact(c, f(x), d)`",
            Intrinsic::Sqrt => "`sqrt(x)`",
            Intrinsic::Any => "`any<<t>>()`",
            Intrinsic::Choose => "`choose { x: t | c }`",
            Intrinsic::Machine(_) => "`(int8 x)`",
            Intrinsic::Time => "`time(x)`: seconds in whole ticks, rounded up",
            Intrinsic::Spatial(op) => op.usage(),
        }
    }
}

/// Checks a call of a predeclared operator and returns its typed expression.
pub(crate) fn check_intrinsic<'a>(
    cx: &mut Body<'_, 'a>,
    special: Intrinsic,
    call: &'a ast::Call,
    span: Span,
) -> ExprId {
    if special == Intrinsic::Condact {
        return check_condact(cx, call, span);
    }
    if let Intrinsic::Machine(name) = special {
        return machine_int::machine_conversion(cx, name, call, span);
    }
    let given = args::check_args(cx, &call.args);
    if let (Intrinsic::Any | Intrinsic::Choose, [of], []) =
        (special, &call.callee.statics[..], &given[..])
    {
        return nondeterministic_value(cx, special, of, span);
    }
    apply_intrinsic(cx, special, &given, span)
}

/// Checks `any` and `choose`, whose values are nondeterministic, and returns a typed expression. A warning reports
/// which value is used at run time.
fn nondeterministic_value<'a>(
    cx: &mut Body<'_, 'a>,
    special: Intrinsic,
    of: &'a ast::StaticArg,
    span: Span,
) -> ExprId {
    // `choose` is a function of its arguments; `any` may change from cycle to cycle.
    if special == Intrinsic::Any {
        cx.record_state(span);
    }
    proof_only::nondeterminism_in_constant(cx, span);
    let Some(ty) = static_args::static_type(cx, of) else {
        return cx.error_expr(span);
    };
    let zero = ty.zero_literal().unwrap_or("false or 0".to_owned());
    report::report_diagnostic(
        cx,
        Diagnostic::new(Code::RPI1013, "nondeterministic value")
            .primary(span, format!("{zero} at run time"))
            .help("a model checker tries all values; to run the program with others, make it an in-port"),
    );
    cx.add(TypedKind::Arbitrary, ty, span)
}

/// Checks the application of a predeclared operator to arguments that have been checked, and returns its typed
/// expression.
pub(crate) fn apply_intrinsic<'a>(
    cx: &mut Body<'_, 'a>,
    special: Intrinsic,
    given: &[CallArgument<'a>],
    span: Span,
) -> ExprId {
    let values: Vec<ExprId> = given.iter().map(|arg| arg.value).collect();
    match (special, &values[..]) {
        (Intrinsic::Present, [x]) => cx.add(TypedKind::Present(*x), Ty::Bool, span),
        (Intrinsic::Hold, [x, init]) => {
            cx.record_state(span);
            let ty = expr::common_type(cx, *x, *init, "this is the value before the first one");
            cx.add(
                TypedKind::Each(ElementwiseOp::Hold, [*x, *init].into()),
                ty,
                span,
            )
        }
        (Intrinsic::Sqrt, [x]) => sqrt(cx, *x, span),
        (Intrinsic::Spatial(op), values) if values.len() == op.operand_count() => {
            spatial_ops::spatial_op(cx, op, values, span)
        }
        (Intrinsic::Time, [x]) => time_conversion(cx, *x, span),
        (Intrinsic::Machine(to), [x]) => match MachineInt::from_name(to) {
            Some(to) => machine_int::convert_to_machine(cx, *x, to, span),
            None => cx.error_expr(span),
        },
        _ => {
            let message = format!(
                "`{}` does not take {}",
                special.name(),
                with_noun(values.len(), "argument")
            );
            let diagnostic = Diagnostic::new(Code::RPI1010, message)
                .primary(span, "wrong number of arguments")
                .help(format!("usage: {}", special.usage()));
            cx.report_error_expr(diagnostic, span)
        }
    }
}

/// Checks `time(x)`, which converts seconds to a time in whole ticks, and returns its typed expression.
fn time_conversion(cx: &mut Body<'_, '_>, x: ExprId, span: Span) -> ExprId {
    if *cx.ty_of(x) == Ty::Duration || exact_time::convert_to_ticks(cx, x) {
        return x;
    }
    match statement::expect_type(
        cx,
        x,
        &crate::ty::machine_types::SECONDS,
        &ExpectationReason::Unexplained,
    ) {
        true => exact_time::ticks_from_seconds(cx, x, span),
        false => cx.add(TypedKind::Error, Ty::Duration, span),
    }
}

fn sqrt(cx: &mut Body<'_, '_>, x: ExprId, span: Span) -> ExprId {
    exact_time::convert_to_seconds(cx, x);
    let dim = match cx.ty_of(x) {
        Ty::Real(dim) => *dim,
        Ty::Unknown => return cx.error_expr(span),
        _ => {
            statement::expect_type(cx, x, &Ty::REAL, &ExpectationReason::Unexplained);
            Dimension::ONE
        }
    };
    let ty = dim.power(Ratio::HALF).map_or(Ty::Unknown, Ty::Real);
    prim::add_prim(cx, prim!("Core::DoubleSquareRoot"), &[x], ty, span)
}

/// Checks `condact(c, f(x), d)` and returns its typed expression.
fn check_condact<'a>(cx: &mut Body<'_, 'a>, call: &'a ast::Call, span: Span) -> ExprId {
    let [every, called, defaults @ ..] = &call.args[..] else {
        return invalid_condact(cx, span);
    };
    let ExprKind::Call(inner) = &called.value.unparen().kind else {
        return invalid_condact(cx, called.value.span);
    };
    cx.record_state(span);
    let every = statement::check_condition(cx, &every.value, "an activation");
    let restart = match &inner.activation {
        ast::Activation::Always => None,
        ast::Activation::Restart { every: restart } => {
            let restart = statement::check_condition(cx, restart, "a restart");
            // Only an active cycle can restart the call.
            let both = [every, restart];
            Some(prim::add_prim(
                cx,
                prim!("Core::BooleanAnd"),
                &both,
                Ty::Bool,
                span,
            ))
        }
        ast::Activation::Activate { .. } => return invalid_condact(cx, called.value.span),
    };
    let defaults: Vec<ExprId> = defaults
        .iter()
        .map(|arg| expr::check_expr(cx, &arg.value))
        .collect();
    let default = match defaults[..] {
        [] => None,
        [one] => Some(one),
        _ => {
            let ty = Ty::tuple(defaults.iter().map(|id| cx.ty_of(*id).clone()));
            Some(cx.add(TypedKind::Build(defaults.into()), ty, span))
        }
    };
    let activation = Activation::Condact {
        every,
        default,
        restart,
    };
    call::call_with_activation(cx, inner, activation, called.value.span)
}

fn invalid_condact(cx: &mut Body<'_, '_>, span: Span) -> ExprId {
    let diagnostic = Diagnostic::new(
        Code::RPI1010,
        "`condact` takes a condition, a call and defaults",
    )
    .primary(span, "invalid arguments")
    .help("write `condact(c, f(x), d)`");
    cx.report_error_expr(diagnostic, span)
}
