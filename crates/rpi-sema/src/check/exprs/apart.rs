//! Help texts and fixes for operands that an operator does not accept.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::number_fixes;
use crate::check::diagnostics::report;
use crate::check::signatures::unit;
use crate::check::types::machine_int;
use crate::check::types::quantity;
use crate::ty::{MachineInt, Member, Ty};
use crate::typed::{ExprId, TypedKind};
use crate::units::Dimension;
use rpi_diag::{Diagnostic, Fix, Quote, Span};
use rpi_image::Scalar::{Pose, Vector};
use rpi_net::prim;
use rpi_syntax::ops::BinaryOp::{
    self, And, Div, Implies, Mul, Or, Pow, ShiftLeft, ShiftRight, Xor,
};

/// Adds help or a fix to the diagnostic about a binary operator that does not accept its two operands. The operands are
/// given with their types.
pub(crate) fn with_operand_hints(
    cx: &Body<'_, '_>,
    diagnostic: Diagnostic,
    op: BinaryOp,
    (left, a): (ExprId, &Ty),
    (right, b): (ExprId, &Ty),
) -> Diagnostic {
    let both = [left, right];
    let mixed = |it, int, dim| with_int_operand_fix(cx, it, op, (both, int), dim);
    match (a, b) {
        (Ty::Bool | Ty::Int | Ty::Real(_), Ty::Bool | Ty::Int | Ty::Real(_))
            if matches!(op, And | Or | Xor | Implies) =>
        {
            let operands = [(cx.span_of(left), a), (cx.span_of(right), b)];
            report::with_condition_help(diagnostic, operands)
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
            let call = [right, left][usize::from(matches!(a, Ty::Tuple(_)))];
            diagnostic.help(output_help(&report::operand_name(cx, call), members))
        }
        (Ty::Machine(of), Ty::Int) => machine_int::with_conversion_fix(cx, diagnostic, *of, right),
        (Ty::Int, Ty::Machine(of)) => machine_int::with_conversion_fix(cx, diagnostic, *of, left),
        (Ty::Machine(of), Ty::Machine(_)) => diagnostic.help(machine_operands_help(
            op,
            *of,
            &report::operand_name(cx, right),
        )),
        (Ty::Bool, number) => {
            diagnostic.help(report::bool_to_number_help(cx.span_of(left), number))
        }
        (number, Ty::Bool) => {
            diagnostic.help(report::bool_to_number_help(cx.span_of(right), number))
        }
        (Ty::Struct(of), _) if of.fields.is_empty() && !unit::reads_rpi_syntax(cx) => diagnostic
            .help(format!(
                "`{0}` stands for any type, whose values can only be passed on and compared by `=`: use a type with this operator, such as `int`, instead of `{0}`",
                of.name
            )),
        (Ty::Array(..), _) | (_, Ty::Array(..)) => {
            let [left, right] = [left, right].map(|id| report::operand_name(cx, id));
            diagnostic.help(elementwise_help(op, (a, &left), (b, &right)))
        }
        (Ty::Spatial(Pose, _), Ty::Spatial(Pose, _)) => {
            let [a, b] = [left, right].map(|id| report::operand_name(cx, id));
            diagnostic.help(format!("poses are composed by `*`: `{a} * {b}`"))
        }
        (Ty::Spatial(Vector, _), Ty::Real(_)) => diagnostic.help(vector_help(cx, op, right, b)),
        (Ty::Real(_), Ty::Spatial(Vector, _)) => diagnostic.help(vector_help(cx, op, left, a)),
        _ => diagnostic,
    }
}

/// Returns the advice to divide instead of multiplying, if the quotient of the factors has the dimension `wanted`.
pub(crate) fn quotient_help(
    cx: &Body<'_, '_>,
    product: ExprId,
    wanted: Dimension,
) -> Option<String> {
    let TypedKind::Prim(call) = &cx.unit.expr(product).kind else {
        return None;
    };
    let [Some(left), Some(right)] = call.inputs[..] else {
        return None;
    };
    let dim = |id: ExprId| match cx.ty_of(id) {
        Ty::Real(dim) => Some(*dim),
        _ => None,
    };
    let quotient = |a: ExprId, b: ExprId| dim(a)?.divided_by(dim(b)?);
    let is_product = call.prim == prim!("Core::DoubleMultiply");
    let (left, right) = match () {
        () if !is_product => return None,
        () if quotient(left, right) == Some(wanted) => (left, right),
        () if quotient(right, left) == Some(wanted) => (right, left),
        () => return None,
    };
    Some(format!(
        "divide instead of multiplying: `{} / {}`",
        report::operand_name(cx, left),
        report::operand_name(cx, right)
    ))
}

/// Returns the help text for an operand that is a call with several outputs. `call` is the source text of the call.
fn output_help(call: &str, members: &[Member]) -> String {
    let names = members.iter().filter_map(|member| member.name.as_deref());
    let outputs: Vec<String> = names.map(|name| format!("`{call}.{name}`")).collect();
    format!("select one output of the call: {}", outputs.join(" or "))
}

/// Returns the help text for a number beside a vector, which only the operators `*` and `/` accept. `ty` is the type of
/// the number.
fn vector_help(cx: &Body<'_, '_>, op: BinaryOp, number: ExprId, ty: &Ty) -> String {
    let (op, number) = (op.spelling(), Quote::text(cx.span_of(number)));
    let zero = ty.zero_literal().unwrap_or("0.0".to_owned());
    format!(
        "`{op}` needs a vector on both sides: along the x-axis it is `vector({number}, {zero}, {zero})`"
    )
}

/// Returns the help text for two machine integers of different types. `left` is the type of the left operand, and
/// `right` is the source text of the right operand.
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

/// Returns whether an integer literal is beside a flow that is declared in per cent, and the operator needs the same unit
/// on both sides.
fn is_per_cent(cx: &Body<'_, '_>, op: BinaryOp, (int, other): (ExprId, ExprId)) -> bool {
    let is_per_cent = match cx.unit.expr(other).kind {
        TypedKind::Flow(flow) => cx.inference.per_cent_flows.contains(&flow),
        _ => false,
    };
    let is_scaled = matches!(op, Mul | Div | Pow);
    is_per_cent && !is_scaled && report::is_number_literal(cx, int)
}

/// Adds the fix that writes an integer literal beside a flow in per cent as a percentage.
fn with_per_cent_fix(diagnostic: Diagnostic, flow: Span, number: Span) -> Diagnostic {
    let (flow, text) = (Quote::text(flow), Quote::text(number));
    diagnostic
        .help(format!(
            "`{flow}` is declared in per cent, and `{text}%` is {text} hundredths"
        ))
        .fix(Fix::maybe("use the unit `%`").insert_after(number, "%"))
}

/// Adds a fix for an integer operand beside a real operand of the dimension `dim`. A literal beside a quantity gets a
/// unit; other integers are converted to real.
fn with_int_operand_fix(
    cx: &Body<'_, '_>,
    diagnostic: Diagnostic,
    op: BinaryOp,
    (operands, int): ([ExprId; 2], ExprId),
    dim: Dimension,
) -> Diagnostic {
    let other = operands[usize::from(operands[0] == int)];
    match op {
        _ if is_per_cent(cx, op, (int, other)) => {
            with_per_cent_fix(diagnostic, cx.span_of(other), cx.span_of(int))
        }
        // Not applied automatically: other languages group `a ** b ** c` differently.
        Pow => diagnostic.fix(number_fixes::to_real_fix(cx, int).into_maybe()),
        Mul | Div => diagnostic.fix(number_fixes::to_real_fix(cx, int)),
        _ if report::is_number_literal(cx, int) && dim != Dimension::ONE => {
            quantity::with_unit_fixes(diagnostic, dim, cx.span_of(int))
        }
        _ => diagnostic.fix(number_fixes::to_real_fix(cx, int)),
    }
}

/// Returns the help text for an operator on numbers that is applied to arrays. It shows how the operator is applied to
/// the elements. Each operand is given by its type and source text.
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
