//! Help texts and fixes for operands that an operator does not accept.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::join_names;
use crate::check::signatures::unit;
use crate::check::types::machine_int;
use crate::check::types::quantity;
use crate::ty::{MachineInt, Ty};
use crate::typed::ExprId;
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
        (Ty::Machine(of), Ty::Machine(_)) => diagnostic.help(machine_operands_help(
            op,
            *of,
            &report::operand_name(cx, right),
        )),
        (Ty::Bool, _) | (_, Ty::Bool) => {
            diagnostic.help("convert a Boolean to a number by `if c then 1 else 0`")
        }
        (Ty::Struct(of), _) if of.fields.is_empty() && !unit::reads_rpi_syntax(cx) => diagnostic
            .help(format!(
                "`{}` stands for any type: its values can only be passed on and compared by `=`",
                of.name
            )),
        (Ty::Array(..), _) | (_, Ty::Array(..)) => {
            let [left, mut right] = [left, right].map(|id| report::operand_name(cx, id));
            if right == "x" {
                "y".clone_into(&mut right);
            }
            diagnostic.help(elementwise_help(op, (a, &left), (b, &right)))
        }
        (Ty::Spatial(Pose, _), Ty::Spatial(Pose, _)) => {
            diagnostic.help("compose poses by `*`: `(b in a) * (c in b)` is the pose of `c` in `a`")
        }
        (Ty::Spatial(Vector, _), Ty::Real(_)) | (Ty::Real(_), Ty::Spatial(Vector, _)) => diagnostic
            .help("add a vector: `point(x, y, z)`; or scale the vector by a number with `*`"),
        _ => diagnostic,
    }
}

/// Returns the help text for two machine integers of different types, given the type of the left operand and the name
/// of the right one.
fn machine_operands_help(op: BinaryOp, left: MachineInt, right: &str) -> String {
    match op {
        ShiftLeft | ShiftRight => {
            let to = MachineInt {
                signed: false,
                ..left
            };
            let to = to.conversion_name();
            format!("the shift count must be unsigned: `({to} {right})`")
        }
        _ => format!(
            "convert one of them: `({} {right})`",
            left.conversion_name()
        ),
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

/// Returns the help text for applying a scalar operator to the elements of arrays, given the types and names of its
/// operands.
fn elementwise_help(op: BinaryOp, (a, left): (&Ty, &str), (b, right): (&Ty, &str)) -> String {
    let op = op.spelling();
    let array = |scalar: &str, n| format!("`{scalar}^{n}` is an array of {n} times `{scalar}`");
    match (a, b) {
        (Ty::Array(_, n), Ty::Array(_, m)) if n == m => {
            format!("apply it to each element: `map<<{op}, {n}>>({left}, {right})`")
        }
        (Ty::Array(_, n), Ty::Array(_, m)) => {
            format!(
                "`{left}` has {n} elements and `{right}` has {m}; take the same number of elements of both"
            )
        }
        (Ty::Array(_, n), _) => format!(
            "apply it to each element: `map<<{op}, {n}>>({left}, {right}^{n})`; {}",
            array(right, n)
        ),
        (_, Ty::Array(_, n)) => format!(
            "apply it to each element: `map<<{op}, {n}>>({left}^{n}, {right})`; {}",
            array(left, n)
        ),
        _ => String::new(),
    }
}
