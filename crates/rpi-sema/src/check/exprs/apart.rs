//! Help texts and fixes for operands that an operator does not accept.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::join_names;
use crate::check::types::machine_int;
use crate::check::types::quantity;
use crate::ty::{MachineInt, Ty};
use crate::typed::{ExprId, TypedKind};
use crate::units::Dimension;
use rpi_diag::Diagnostic;
use rpi_image::Scalar::{Pose, Vector};
use rpi_syntax::ops::BinaryOp::{
    self, And, Div, Implies, Mul, Or, Pow, ShiftLeft, ShiftRight, Xor,
};

/// Adds help or a fix to the diagnostic about two operands that the operator does not accept.
pub(crate) fn with_operand_hints(
    cx: &Body<'_, '_>,
    diagnostic: Diagnostic,
    op: BinaryOp,
    (left, a): (ExprId, &Ty),
    (right, b): (ExprId, &Ty),
) -> Diagnostic {
    let mixed = |diagnostic, int, dim| with_int_operand_fix(cx, diagnostic, op, int, dim);
    match (a, b) {
        (Ty::Bool | Ty::Int | Ty::Real(_), Ty::Bool | Ty::Int | Ty::Real(_))
            if matches!(op, And | Or | Xor | Implies) =>
        {
            diagnostic.help("a condition is a comparison: `x <> 0`, `x > 0.0`")
        }
        (Ty::Int, Ty::Real(dim)) => mixed(diagnostic, left, *dim),
        (Ty::Real(dim), Ty::Int) => mixed(diagnostic, right, *dim),
        (Ty::Int, Ty::Duration) if report::is_number_literal(cx, left) => {
            mixed(diagnostic, left, Dimension::TIME)
        }
        (Ty::Duration, Ty::Int) if report::is_number_literal(cx, right) => {
            mixed(diagnostic, right, Dimension::TIME)
        }
        (Ty::Tuple(members), _) | (_, Ty::Tuple(members)) => {
            let names = members.iter().filter_map(|m| m.name.as_deref());
            diagnostic.help(format!(
                "select one output of the call by its name: {}",
                join_names(names)
            ))
        }
        (Ty::Machine(of), Ty::Int) => machine_int::with_conversion_fix(cx, diagnostic, *of, right),
        (Ty::Int, Ty::Machine(of)) => machine_int::with_conversion_fix(cx, diagnostic, *of, left),
        (Ty::Machine(of), Ty::Machine(_)) if matches!(op, ShiftLeft | ShiftRight) => {
            let to = MachineInt {
                signed: false,
                ..*of
            }
            .conversion_name();
            let count = operand_name(cx, right);
            diagnostic.help(format!(
                "the shift count must be unsigned: `({to} {count})`"
            ))
        }
        (Ty::Machine(of), Ty::Machine(_)) => diagnostic.help(format!(
            "convert one of them: `({} {})`",
            of.conversion_name(),
            operand_name(cx, right)
        )),
        (Ty::Bool, _) | (_, Ty::Bool) => {
            diagnostic.help("convert a Boolean to a number by `if c then 1 else 0`")
        }
        (Ty::Array(..), _) | (_, Ty::Array(..)) => diagnostic.help(elementwise_help(op, a, b)),
        (Ty::Spatial(Pose, _), Ty::Spatial(Pose, _)) => {
            diagnostic.help("compose poses by `*`: `(b in a) * (c in b)` is the pose of `c` in `a`")
        }
        (Ty::Spatial(Vector, _), Ty::Real(_)) | (Ty::Real(_), Ty::Spatial(Vector, _)) => diagnostic
            .help("add a vector: `point(x, y, z)`; or scale the vector by a number with `*`"),
        _ => diagnostic,
    }
}

/// Adds a fix for an integer operand beside a real one: a unit for a literal beside a quantity, else a conversion
/// to real.
fn with_int_operand_fix(
    cx: &Body<'_, '_>,
    diagnostic: Diagnostic,
    op: BinaryOp,
    int: ExprId,
    dim: Dimension,
) -> Diagnostic {
    match op {
        // Not applied automatically: other languages group `a ** b ** c` differently.
        Pow => diagnostic.fix(report::to_real_fix(cx, int).into_maybe()),
        Mul | Div => diagnostic.fix(report::to_real_fix(cx, int)),
        _ if report::is_number_literal(cx, int) && dim != Dimension::ONE => {
            quantity::with_unit_fixes(diagnostic, dim, cx.span_of(int))
        }
        _ => diagnostic.fix(report::to_real_fix(cx, int)),
    }
}

/// Returns the help text for applying a scalar operator to the elements of arrays.
fn elementwise_help(op: BinaryOp, a: &Ty, b: &Ty) -> String {
    let op = op.spelling();
    match (a, b) {
        (Ty::Array(_, n), Ty::Array(_, m)) if n == m => {
            format!("apply it to each element: `map<<{op}, {n}>>(a, b)`")
        }
        (Ty::Array(_, n), _) | (_, Ty::Array(_, n)) => format!(
            "apply it to each element: `map<<{op}, {n}>>(a, b)`; `x^{n}` is an array of {n} times `x`"
        ),
        _ => String::new(),
    }
}

/// Returns the name of an operand for an example in a help text: of the flow that it reads, else `x`.
fn operand_name(cx: &Body<'_, '_>, operand: ExprId) -> String {
    match &cx.unit.expr(operand).kind {
        TypedKind::Flow(flow) => cx.unit.flow(*flow).name.to_string(),
        _ => "x".to_owned(),
    }
}
