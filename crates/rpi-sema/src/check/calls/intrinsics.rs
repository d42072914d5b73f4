//! Predeclared operators in call syntax. A declaration of the same name hides them.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::calls::args;
use crate::check::calls::args::Given;
use crate::check::calls::call;
use crate::check::calls::prim;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::Wanted;
use crate::check::exprs::expr;
use crate::check::exprs::proof_only;
use crate::check::exprs::spatial_ops;
use crate::check::exprs::spatial_ops::SpatialOp;
use crate::check::signatures::static_args;
use crate::check::types::exact_time;
use crate::check::types::machine_int;
use crate::ty::{MachineInt, Ty};
use crate::typed::ExprId;
use crate::typed::{Activation, Each, Kind};
use crate::units::{Dim, Ratio};
use rpi_diag::counted;
use rpi_diag::{Code, Finding, Span};
use rpi_net::prim;
use rpi_syntax::ast::{self, ExprKind};

/// A predeclared operator in call syntax.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Special {
    /// `present(x)`: whether a flow is present in this cycle.
    Present,
    /// `hold(x, init)`: the latest present value; `init` before the first one.
    Hold,
    /// `condact(c, f(x), d)`: `f(x)` in cycles in which `c` holds, else its previous value; `d` before the first one.
    Condact,
    /// `sqrt(x)`: square root of the value and of its dimension.
    Sqrt,
    /// `any<<t>>()`, `any@<t>` of Kind 2: a nondeterministic value.
    Any,
    /// `choose { x: t | c }` of Kind 2: a nondeterministic value that is always the same for the same arguments.
    Choose,
    /// `(int8 x)` of Kind 2: conversion to a machine integer.
    Machine(&'static str),
    /// `time(x)`: conversion of seconds to a time in whole ticks, rounded up.
    Time,
    /// `norm(v)` and the other operators on vectors, rotations and poses.
    Spatial(SpatialOp),
}

/// All predeclared operators in call syntax.
pub(crate) const SPECIALS: &[Special] = &[
    Special::Present,
    Special::Hold,
    Special::Condact,
    Special::Sqrt,
    Special::Any,
    Special::Choose,
    Special::Time,
    Special::Machine("int8"),
    Special::Machine("int16"),
    Special::Machine("int32"),
    Special::Machine("int64"),
    Special::Machine("uint8"),
    Special::Machine("uint16"),
    Special::Machine("uint32"),
    Special::Machine("uint64"),
    Special::Machine("sint"),
    Special::Machine("uint"),
    Special::Spatial(SpatialOp::Vector),
    Special::Spatial(SpatialOp::Dot),
    Special::Spatial(SpatialOp::Cross),
    Special::Spatial(SpatialOp::Norm),
    Special::Spatial(SpatialOp::Inverse),
];

impl Special {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Special::Present => "present",
            Special::Hold => "hold",
            Special::Condact => "condact",
            Special::Sqrt => "sqrt",
            Special::Any => "any",
            Special::Choose => "choose",
            Special::Machine(name) => name,
            Special::Time => "time",
            Special::Spatial(op) => op.name(),
        }
    }
}

impl Special {
    /// Returns the syntax of a call and the result, for help texts.
    fn form(self) -> &'static str {
        match self {
            Special::Present => "`present(x)`: whether `x` is present",
            Special::Hold => {
                "`hold(x, init)`: the latest value of `x`, `init` before the first one"
            }
            Special::Condact => "`condact(c, f(x), d)`",
            Special::Sqrt => "`sqrt(x)`",
            Special::Any => "`any<<t>>()`",
            Special::Choose => "`choose { x: t | c }`",
            Special::Machine(_) => "`(int8 x)`",
            Special::Time => "`time(x)`: seconds in whole ticks, rounded up",
            Special::Spatial(op) => op.form(),
        }
    }
}

/// Checks a call of a predeclared operator.
pub(crate) fn check_intrinsic<'a>(
    cx: &mut Body<'_, 'a>,
    special: Special,
    call: &'a ast::Call,
    span: Span,
) -> ExprId {
    if special == Special::Condact {
        return check_condact(cx, call, span);
    }
    if let Special::Machine(name) = special {
        return machine_int::machine_conversion(cx, name, call, span);
    }
    let given = args::check_args(cx, &call.args);
    if let (Special::Any | Special::Choose, [of], []) =
        (special, &call.callee.statics[..], &given[..])
    {
        return nondeterministic_value(cx, special, of, span);
    }
    apply_intrinsic(cx, special, &given, span)
}

/// Checks `any` and `choose`, whose values are nondeterministic.
fn nondeterministic_value<'a>(
    cx: &mut Body<'_, 'a>,
    special: Special,
    of: &'a ast::StaticArg,
    span: Span,
) -> ExprId {
    // `choose` is a function of its arguments; `any` may change from cycle to cycle.
    if special == Special::Any {
        cx.has_state(span);
    }
    proof_only::nondeterminism_in_constant(cx, span);
    let Some(ty) = static_args::static_type(cx, of) else {
        return cx.fault(span);
    };
    report::report_diagnostic(
        cx,
        Finding::new(Code::RPI1013, "nondeterministic value").at(span, "false or 0 at run time"),
    );
    cx.add(Kind::Outside, ty, span)
}

/// Checks a predeclared operator with checked arguments.
pub(crate) fn apply_intrinsic<'a>(
    cx: &mut Body<'_, 'a>,
    special: Special,
    given: &[Given<'a>],
    span: Span,
) -> ExprId {
    let values: Vec<ExprId> = given.iter().map(|arg| arg.value).collect();
    match (special, &values[..]) {
        (Special::Present, [x]) => cx.add(Kind::Present(*x), Ty::Bool, span),
        (Special::Hold, [x, init]) => {
            cx.has_state(span);
            let ty = expr::common_type(cx, *x, *init, "this is the value before the first one");
            cx.add(Kind::Each(Each::Hold, [*x, *init].into()), ty, span)
        }
        (Special::Sqrt, [x]) => sqrt(cx, *x, span),
        (Special::Spatial(op), values) if values.len() == op.operands() => {
            spatial_ops::spatial_op(cx, op, values, span)
        }
        (Special::Time, [x]) => time_conversion(cx, *x, span),
        (Special::Machine(to), [x]) => match MachineInt::named(to) {
            Some(to) => machine_int::convert_to_machine(cx, *x, to, span),
            None => cx.fault(span),
        },
        _ => {
            let message = format!(
                "`{}` does not take {}",
                special.name(),
                counted(values.len(), "argument")
            );
            let finding = Finding::new(Code::RPI1010, message)
                .at(span, "wrong number of arguments")
                .help(format!("usage: {}", special.form()));
            cx.fault_with(finding, span)
        }
    }
}

/// Checks `time(x)`: seconds as a time in whole ticks.
fn time_conversion(cx: &mut Body<'_, '_>, x: ExprId, span: Span) -> ExprId {
    if *cx.ty_of(x) == Ty::Duration || exact_time::convert_to_ticks(cx, x) {
        return x;
    }
    match statement::expect_type(
        cx,
        x,
        &crate::check::types::exact_time::SECONDS,
        &Wanted::Here,
    ) {
        true => exact_time::ticks_from_seconds(cx, x, span),
        false => cx.add(Kind::Fault, Ty::Duration, span),
    }
}

fn sqrt(cx: &mut Body<'_, '_>, x: ExprId, span: Span) -> ExprId {
    exact_time::convert_to_seconds(cx, x);
    let dim = match cx.ty_of(x) {
        Ty::Real(dim) => *dim,
        Ty::Unknown => return cx.fault(span),
        _ => {
            statement::expect_type(cx, x, &Ty::REAL, &Wanted::Here);
            Dim::ONE
        }
    };
    let ty = dim.power(Ratio::HALF).map_or(Ty::Unknown, Ty::Real);
    prim::add_prim(cx, prim!("Core::DoubleSquareRoot"), &[x], ty, span)
}

/// Checks `condact(c, f(x), d)`.
fn check_condact<'a>(cx: &mut Body<'_, 'a>, call: &'a ast::Call, span: Span) -> ExprId {
    let [every, called, defaults @ ..] = &call.args[..] else {
        return invalid_condact(cx, span);
    };
    let ExprKind::Call(inner) = &called.value.unparen().kind else {
        return invalid_condact(cx, called.value.span);
    };
    cx.has_state(span);
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
            Some(cx.add(Kind::Build(defaults.into()), ty, span))
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
    let finding = Finding::new(
        Code::RPI1010,
        "`condact` takes a condition, a call and defaults",
    )
    .at(span, "invalid arguments")
    .help("write `condact(c, f(x), d)`");
    cx.fault_with(finding, span)
}
