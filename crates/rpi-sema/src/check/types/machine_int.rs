//! Machine integers of Kind 2 (`int8` to `uint64`, `uint<N>`): conversions, operators and bit access. Results wrap
//! around.

use crate::check::bodies::body::Body;
use crate::check::calls::prim;
use crate::check::diagnostics::report;
use crate::check::exprs::expr;
use crate::check::exprs::ops;
use crate::check::exprs::proof_only;
use crate::check::signatures::unit;
use crate::check::types::consts;
use crate::ty::{MachineInt, Ty};
use crate::typed::TypedKind;
use crate::typed::{ExprId, Leaf};
use rpi_diag::{Code, Diagnostic, Fix, Quote, Span};
use rpi_net::prim;
use rpi_prims::PrimId;
use rpi_syntax::ast::{Binary, BitRange, Call, Expr, ExprKind, StaticArg, StaticValue};
use rpi_syntax::ops::{BinaryOp, UnaryOp};

/// Checks a conversion to a machine integer of Kind 2, such as `(int8 x)` or `(sint@<25> x)`, and returns its typed
/// expression.
pub(crate) fn machine_conversion<'a>(
    cx: &mut Body<'_, 'a>,
    name: &str,
    call: &'a Call,
    span: Span,
) -> ExprId {
    let [arg] = &call.args[..] else {
        let diagnostic = Diagnostic::new(Code::RPI1010, format!("`{name}` takes one argument"))
            .primary(span, "wrong number of arguments");
        return cx.report_error_expr(diagnostic, span);
    };
    let Some(to) = machine_int_type(cx, name, &call.callee.statics, span) else {
        expr::check_expr(cx, &arg.value);
        return cx.error_expr(span);
    };
    match large_literal_bits(&arg.value) {
        Some(bits) => {
            let bits = cx.add(TypedKind::Literal(Leaf::int(bits)), Ty::Int, arg.value.span);
            wrap_to_width(cx, bits, to, span)
        }
        None => {
            let value = expr::check_expr(cx, &arg.value);
            convert_to_machine(cx, value, to, span)
        }
    }
}

/// Returns the machine integer type with this name, and with the number of bits in `statics` if there is one. `None`
/// after an error or for more than 64 bits.
pub(crate) fn machine_int_type<'a>(
    cx: &mut Body<'_, 'a>,
    name: &str,
    statics: &'a [StaticArg],
    span: Span,
) -> Option<MachineInt> {
    let bits = match statics {
        [] => return MachineInt::from_name(name),
        [
            StaticArg {
                value: StaticValue::Expr(bits),
                ..
            },
        ] => consts::const_integer(cx, bits)?,
        _ => return None,
    };
    let found = MachineInt::new(name == "sint", bits);
    if found.is_none() && bits < 1 {
        let message = format!("invalid number of bits: {bits}");
        let diagnostic = Diagnostic::new(Code::RPI2009, message);
        report::report_diagnostic(
            cx,
            diagnostic
                .primary(span, "a machine integer has at least one bit")
                .help("use a size from 1 to 64 bits"),
        );
    } else if found.is_none() {
        proof_only::not_executable(
            cx,
            "a machine integer of more than 64 bits",
            "at most 64 bits are supported",
            span,
        );
    }
    found
}

/// Adds the conversion of an integer or machine integer that has been checked to the machine integer type `to`, and
/// returns it. Reports an operand of another type.
pub(crate) fn convert_to_machine(
    cx: &mut Body<'_, '_>,
    value: ExprId,
    to: MachineInt,
    span: Span,
) -> ExprId {
    match cx.ty_of(value).clone() {
        Ty::Unknown => cx.add(TypedKind::Error, Ty::Machine(to), span),
        Ty::Int | Ty::Machine(_) => wrap_to_width(cx, value, to, span),
        found => {
            let diagnostic =
                Diagnostic::new(Code::RPI2006, format!("cannot convert `{found}` to `{to}`"))
                    .primary(cx.span_of(value), format!("this is `{found}`"))
                    .help(match found {
                        Ty::Real(_) => {
                            let to = to.conversion_name();
                            format!(
                                "convert it to an integer first: `({to} (int {}))`",
                                Quote::operand(cx.span_of(value))
                            )
                        }
                        _ => "only integers and machine integers can be converted".to_owned(),
                    });
            cx.report_error_expr(diagnostic, span)
        }
    }
}

fn wrap_to_width(cx: &mut Body<'_, '_>, value: ExprId, to: MachineInt, span: Span) -> ExprId {
    let width = signed_width(cx, to, span);
    prim::add_prim(
        cx,
        prim!("Rpi::MachineWrap"),
        &[value, width],
        Ty::Machine(to),
        span,
    )
}

fn signed_width(cx: &mut Body<'_, '_>, of: MachineInt, span: Span) -> ExprId {
    int_literal(cx, of.width_literal(), span)
}

fn int_literal(cx: &mut Body<'_, '_>, bits: i64, span: Span) -> ExprId {
    cx.add(TypedKind::Literal(Leaf::int(bits)), Ty::Int, span)
}

/// Checks a unary operator on a machine integer of the type `of` and returns its typed expression. Returns `None` if
/// the operator is not defined for machine integers.
pub(crate) fn machine_unary(
    cx: &mut Body<'_, '_>,
    op: UnaryOp,
    operand: ExprId,
    of: MachineInt,
    span: Span,
) -> Option<ExprId> {
    let width = signed_width(cx, of, span);
    let ty = Ty::Machine(of);
    Some(match op {
        UnaryOp::Neg => {
            // There is no negation primitive; `0 - x` wraps around in the same way.
            let zero = int_literal(cx, 0, span);
            let operands = [zero, operand, width];
            prim::add_prim(cx, prim!("Rpi::MachineSubtract"), &operands, ty, span)
        }
        UnaryOp::BitNot => {
            prim::add_prim(cx, prim!("Rpi::MachineNot"), &[operand, width], ty, span)
        }
        UnaryOp::ToInt => prim::add_prim(
            cx,
            prim!("Rpi::MachineToInt"),
            &[operand, width],
            Ty::Int,
            span,
        ),
        _ => return None,
    })
}

/// Whether a binary operator accepts a right operand of the type `right` beside a machine integer of the type `left`. A
/// shift count must be unsigned.
fn accepts_operand(op: BinaryOp, left: MachineInt, right: &Ty) -> bool {
    match (op, right) {
        (BinaryOp::ShiftLeft | BinaryOp::ShiftRight, Ty::Machine(count)) => !count.signed,
        (_, Ty::Machine(other)) => *other == left,
        _ => false,
    }
}

/// Checks a binary operator on two machine integers and returns its typed expression. Returns `None` if the operator is
/// not defined for the types of its operands.
pub(crate) fn machine_binary(
    cx: &mut Body<'_, '_>,
    op: BinaryOp,
    [left, right]: [ExprId; 2],
    span: Span,
) -> Option<ExprId> {
    let Ty::Machine(of) = *cx.ty_of(left) else {
        return None;
    };
    let right = convert_shift_count(cx, op, right, of, span);
    if !accepts_operand(op, of, cx.ty_of(right)) {
        return None;
    }
    if let Some((prim, swapped)) = comparison_prim(op) {
        let width = signed_width(cx, of, span);
        let operands = if swapped {
            [right, left, width]
        } else {
            [left, right, width]
        };
        return Some(prim::add_prim(cx, prim, &operands, Ty::Bool, span));
    }
    let prim = arithmetic_prim(op)?;
    let mut operands = vec![left, right];
    if prim.desc().inputs.len() > 2 {
        operands.push(signed_width(cx, of, span));
    }
    Some(prim::add_prim(cx, prim, &operands, Ty::Machine(of), span))
}

/// Returns the operand `by`, converted if it is the count of a shift such as `x lsh 3` and an integer: it becomes an
/// unsigned machine integer of the width of `x`, whose type is `of`.
fn convert_shift_count(
    cx: &mut Body<'_, '_>,
    op: BinaryOp,
    by: ExprId,
    of: MachineInt,
    span: Span,
) -> ExprId {
    let shifts = matches!(op, BinaryOp::ShiftLeft | BinaryOp::ShiftRight);
    match shifts && *cx.ty_of(by) == Ty::Int {
        true => wrap_to_width(
            cx,
            by,
            MachineInt {
                signed: false,
                ..of
            },
            span,
        ),
        false => by,
    }
}

/// Checks the bit concatenation `x ++ y` of Kind 2 and returns its typed expression.
pub(crate) fn bit_concat<'a>(cx: &mut Body<'_, 'a>, binary: &'a Binary, span: Span) -> ExprId {
    let both = [
        expr::check_expr(cx, &binary.lhs),
        expr::check_expr(cx, &binary.rhs),
    ];
    if both.iter().any(|id| cx.ty_of(*id).is_unknown()) {
        return cx.error_expr(span);
    }
    let joined = concat_bits(cx, both, span);
    joined
        .unwrap_or_else(|| ops::unsupported_operands(cx, BinaryOp::Append, both[0], both[1], span))
}

/// Adds the fix that converts an integer operand to the machine integer type of the other operand.
pub(crate) fn with_conversion_fix(
    cx: &Body<'_, '_>,
    diagnostic: Diagnostic,
    of: MachineInt,
    int: ExprId,
) -> Diagnostic {
    let span = cx.span_of(int);
    let to = of.conversion_name();
    let fix = Fix::maybe(format!("convert with `{to}`"));
    diagnostic.fix(
        fix.insert_before(span, format!("({to} "))
            .insert_after(span, ")"),
    )
}

/// Concatenates the bits of two machine integers, with those of `high` above those of `low`, and returns the
/// expression. Returns `None` for operands of other types.
fn concat_bits(cx: &mut Body<'_, '_>, [high, low]: [ExprId; 2], span: Span) -> Option<ExprId> {
    let (&Ty::Machine(above), &Ty::Machine(below)) = (cx.ty_of(high), cx.ty_of(low)) else {
        return None;
    };
    let bits = i64::from(above.bits) + i64::from(below.bits);
    let Some(whole) = MachineInt::new(above.signed, bits) else {
        proof_only::not_executable(
            cx,
            "a machine integer of more than 64 bits",
            "at most 64 bits are supported",
            span,
        );
        return Some(cx.error_expr(span));
    };
    let (plain, ty) = (
        MachineInt {
            signed: false,
            ..below
        },
        Ty::Machine(whole),
    );
    let places = int_literal(cx, i64::from(below.bits), span);
    let width = signed_width(cx, whole, span);
    let shift = prim!("Rpi::MachineShiftLeft");
    let high = prim::add_prim(cx, shift, &[high, places, width], ty.clone(), span);
    let low = wrap_to_width(cx, low, plain, span);
    Some(prim::add_prim(
        cx,
        prim!("Rpi::MachineOr"),
        &[high, low],
        ty,
        span,
    ))
}

/// Checks a bit slice of a machine integer, such as `x[7:0]`, and returns its typed expression.
pub(crate) fn bit_slice<'a>(cx: &mut Body<'_, 'a>, of: &'a BitRange, span: Span) -> ExprId {
    let base = expr::check_expr(cx, &of.base);
    let bounds = [&of.high, &of.low].map(|bound| consts::const_integer(cx, bound));
    let ty = cx.ty_of(base).clone();
    let known = ty.is_unknown() || bounds.contains(&None);
    let [Some(high), Some(low)] = bounds else {
        return cx.error_expr(span);
    };
    // In RPI text the parser has already reported the bit slice.
    if known || unit::reads_rpi_syntax(cx) {
        return cx.error_expr(span);
    }
    let Ty::Machine(machine) = ty else {
        let diagnostic = Diagnostic::new(Code::RPI2006, "only a machine integer has bits")
            .primary(of.base.span, format!("this is `{ty}`"))
            .help(format!(
                "convert it to a machine integer first, such as `(uint8 {})`",
                Quote::operand(of.base.span)
            ));
        return cx.report_error_expr(diagnostic, span);
    };
    for (bit, at) in [(high, &of.high), (low, &of.low)] {
        if !(0..i64::from(machine.bits)).contains(&bit) {
            return cx.report_error_expr(bit_out_of_range(bit, machine, at), span);
        }
    }
    let Some(part) = MachineInt::new(false, high - low + 1) else {
        let diagnostic = Diagnostic::new(Code::RPI2009, "empty bit range")
            .primary(span, format!("from {high} down to {low}"))
            .help(format!(
                "the highest bit comes first: `{}[{low}:{high}]`",
                Quote::operand(of.base.span)
            ));
        return cx.report_error_expr(diagnostic, span);
    };
    let (places, width) = (int_literal(cx, low, span), signed_width(cx, machine, span));
    let shift = prim!("Rpi::MachineShiftRight");
    let moved = prim::add_prim(
        cx,
        shift,
        &[base, places, width],
        Ty::Machine(machine),
        span,
    );
    wrap_to_width(cx, moved, part, span)
}

/// Returns the bits of a number literal from 2^63 on, which exceeds a signed 64-bit integer; `None` for any other
/// expression.
fn large_literal_bits(value: &Expr) -> Option<i64> {
    match &value.kind {
        ExprKind::Number(number) => {
            let bits = number
                .u64_value()
                .filter(|bits| i64::try_from(*bits).is_err());
            bits.map(u64::cast_signed)
        }
        _ => None,
    }
}

/// Returns the primitive that compares machine integers, and whether it takes the right operand first; `None` if the
/// operator is no comparison.
fn comparison_prim(op: BinaryOp) -> Option<(PrimId, bool)> {
    Some(match op {
        BinaryOp::Gt => (prim!("Rpi::MachineGreater"), false),
        BinaryOp::Lt => (prim!("Rpi::MachineGreater"), true),
        BinaryOp::Ge => (prim!("Rpi::MachineGreaterOrEqual"), false),
        BinaryOp::Le => (prim!("Rpi::MachineGreaterOrEqual"), true),
        _ => return None,
    })
}

fn arithmetic_prim(op: BinaryOp) -> Option<PrimId> {
    Some(match op {
        BinaryOp::Add => prim!("Rpi::MachineAdd"),
        BinaryOp::Sub => prim!("Rpi::MachineSubtract"),
        BinaryOp::Mul => prim!("Rpi::MachineMultiply"),
        BinaryOp::Div | BinaryOp::IntDiv => prim!("Rpi::MachineDivide"),
        BinaryOp::Mod => prim!("Rpi::MachineModulo"),
        BinaryOp::BitAnd => prim!("Rpi::MachineAnd"),
        BinaryOp::BitOr => prim!("Rpi::MachineOr"),
        BinaryOp::ShiftLeft => prim!("Rpi::MachineShiftLeft"),
        BinaryOp::ShiftRight => prim!("Rpi::MachineShiftRight"),
        _ => return None,
    })
}

fn bit_out_of_range(bit: i64, of: MachineInt, at: &Expr) -> Diagnostic {
    let bits = rpi_diag::with_noun(usize::from(of.bits), "bit");
    Diagnostic::new(Code::RPI2009, format!("bit index {bit} is out of range"))
        .primary(at.span, format!("the integer has {bits}, counted from 0"))
        .help(format!(
            "use an index from 0 to {}",
            of.bits.saturating_sub(1)
        ))
}
