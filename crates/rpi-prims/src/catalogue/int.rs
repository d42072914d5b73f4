//! Arithmetic and comparison of 64-bit integers. Overflow is a fault; results never wrap.

use crate::context::{Context, FaultCode, FaultValues};
use crate::macros::primitive;
use crate::registry::Prim;

pub(super) const ALL: &[Prim] = &[
    ADD,
    MULTIPLY,
    DIVIDE,
    EQUALS,
    GREATER,
    DOUBLE_FROM_INT,
    INT_FROM_DOUBLE,
];

primitive! {
    /// Sum of two integers. Overflow is a fault.
    ADD = "Core::IntAdd";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: i64 }
    presence strict work 1 faults;
    c Value("rpi_int_add(cx, at, inFirst, inSecond)");
    full |cx, place, _, _, (a, b)| (or_overflow_fault(cx, place, a.checked_add(b)),)
}

primitive! {
    /// Product of two integers. Overflow is a fault.
    MULTIPLY = "Core::IntMultiply";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: i64 }
    presence strict work 1 faults;
    c Value("rpi_int_multiply(cx, at, inFirst, inSecond)");
    full |cx, place, _, _, (a, b)| (or_overflow_fault(cx, place, a.checked_mul(b)),)
}

primitive! {
    /// Quotient of two integers, truncated towards 0. Division by zero and overflow are faults.
    DIVIDE = "Core::IntDivide";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: i64 }
    presence strict work 10 faults;
    c Value("rpi_int_divide(cx, at, inFirst, inSecond)");
    full |cx, place, _, _, (a, b)| (or_division_fault(cx, place, b, a.checked_div(b)),)
}

primitive! {
    /// True if the operands differ by at most `Epsilon`. False if `Epsilon` is negative.
    EQUALS = "Core::IntEquals";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    param { Epsilon: i64 = Int(0) }
    out { outValue: bool }
    presence strict work 1;
    c Value("rpi_int_near(inFirst, inSecond, Epsilon)");
    full |_, _, _, (epsilon,), (a, b)| (u64::try_from(epsilon).is_ok_and(|e| a.abs_diff(b) <= e),)
}

primitive! {
    /// True if the first operand is greater than the second.
    GREATER = "Core::IntGreater";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: bool }
    presence strict work 1;
    c Value("inFirst > inSecond");
    pure |(a, b)| (a > b,)
}

primitive! {
    /// Nearest real to an integer.
    DOUBLE_FROM_INT = "Core::DoubleFromInt";
    in { inValue: i64 = Value(Int(1)) }
    out { outValue: f64 }
    presence strict work 1;
    c Value("(double)inValue");
    pure |(a,)| (a as f64,)
}

primitive! {
    /// Integer part of a real, truncated towards 0. Not-a-number, infinities and values out of the 64-bit range are
    /// faults.
    INT_FROM_DOUBLE = "Core::IntFromDouble";
    in { inValue: f64 = Value(Real(1.0)) }
    out { outValue: i64 }
    presence strict work 1 faults;
    c Value("rpi_int_from_real(cx, at, inValue)");
    full |cx, place, _, _, (a,)| (truncate_or_fault(cx, place, a),)
}

/// Returns the result of an integer operation; for `None`, an overflow, raises a fault at slot `place` and returns 0.
#[inline(always)]
pub(super) fn or_overflow_fault(cx: &mut Context<'_>, place: u32, result: Option<i64>) -> i64 {
    result.unwrap_or_else(|| {
        cx.fault(FaultCode::IntegerOverflow, place);
        0
    })
}

/// Returns the result of a division by `divisor`; for `None`, raises a fault for division by zero or overflow at slot
/// `place` and returns 0.
#[inline(always)]
pub(super) fn or_division_fault(
    cx: &mut Context<'_>,
    place: u32,
    divisor: i64,
    result: Option<i64>,
) -> i64 {
    result.unwrap_or_else(|| {
        let code = if divisor == 0 {
            FaultCode::DivisionByZero
        } else {
            FaultCode::IntegerOverflow
        };
        cx.fault(code, place);
        0
    })
}

/// Raises, at slot `place`, the fault of a real number whose integer part is not a 64-bit integer.
#[cold]
pub(super) fn lossy_conversion(cx: &mut Context<'_>, place: u32, real: f64) {
    let bits = real.to_bits();
    cx.fault_by(
        FaultCode::LossyConversion,
        place,
        FaultValues::Real { bits },
    );
}

/// Returns the integer part of a real, truncated towards 0; if it is not a 64-bit integer, raises a fault at slot
/// `place` and returns 0.
#[inline(always)]
pub(super) fn truncate_or_fault(cx: &mut Context<'_>, place: u32, real: f64) -> i64 {
    // 2^63. As a real it is exact, and all reals below it fit in 64 bits.
    const LIMIT: f64 = 9_223_372_036_854_775_808.0;
    if (-LIMIT..LIMIT).contains(&real) {
        return real as i64;
    }
    lossy_conversion(cx, place, real);
    0
}
