//! Operators on 64-bit integers. Overflow is a fault; results never wrap.

use crate::catalogue::int::{or_division_fault, or_overflow_fault};
use crate::macros::primitive;
use crate::registry::Prim;

pub(in crate::catalogue) const ALL: &[Prim] = &[
    SUBTRACT,
    NEGATE,
    MODULO,
    POWER,
    ABSOLUTE,
    MINIMUM,
    MAXIMUM,
    GREATER_OR_EQUAL,
];

primitive! {
    /// Difference of two integers. Overflow is a fault.
    SUBTRACT = "Rpi::IntSubtract";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: i64 }
    presence strict work 1 faults;
    c Value("rpi_int_subtract(cx, at, inFirst, inSecond)");
    full |cx, place, _, _, (a, b)| (or_overflow_fault(cx, place, i64::checked_sub(a, b)),)
}

primitive! {
    /// Negated integer. Overflow is a fault.
    NEGATE = "Rpi::IntNegate";
    in { inValue: i64 = Value(Int(0)) }
    out { outValue: i64 }
    presence strict work 1 faults;
    c Value("rpi_int_negate(cx, at, inValue)");
    full |cx, place, _, _, (a,)| (or_overflow_fault(cx, place, i64::checked_neg(a)),)
}

primitive! {
    /// Remainder of the division truncated towards 0. It has the sign of the first operand, as in C. Division by zero
    /// is a fault.
    MODULO = "Rpi::IntModulo";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(1)) }
    out { outValue: i64 }
    presence strict work 10 faults;
    c Value("rpi_int_modulo(cx, at, inFirst, inSecond)");
    full |cx, place, _, _, (a, b)| (or_division_fault(cx, place, b, remainder(a, b)),)
}

primitive! {
    /// First operand to the power of the second. A negative exponent and overflow are faults.
    POWER = "Rpi::IntPower";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(1)) }
    out { outValue: i64 }
    presence strict work 64 faults;
    c Value("rpi_int_power(cx, at, inFirst, inSecond)");
    full |cx, place, _, _, (a, b)| (or_overflow_fault(cx, place, power(a, b)),)
}

primitive! {
    /// Absolute value of an integer. Overflow is a fault.
    ABSOLUTE = "Rpi::IntAbsolute";
    in { inValue: i64 = Value(Int(0)) }
    out { outValue: i64 }
    presence strict work 1 faults;
    c Value("rpi_int_absolute(cx, at, inValue)");
    full |cx, place, _, _, (a,)| (or_overflow_fault(cx, place, i64::checked_abs(a)),)
}

primitive! {
    /// The smaller of two integers.
    MINIMUM = "Rpi::IntMinimum";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: i64 }
    presence strict work 1;
    c Value("inFirst < inSecond ? inFirst : inSecond");
    pure |(a, b): (i64, i64)| (a.min(b),)
}

primitive! {
    /// The greater of two integers.
    MAXIMUM = "Rpi::IntMaximum";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: i64 }
    presence strict work 1;
    c Value("inFirst > inSecond ? inFirst : inSecond");
    pure |(a, b): (i64, i64)| (a.max(b),)
}

primitive! {
    /// True if the first operand is greater than or equal to the second.
    GREATER_OR_EQUAL = "Rpi::IntGreaterOrEqual";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: bool }
    presence strict work 1;
    c Value("inFirst >= inSecond");
    pure |(a, b): (i64, i64)| (a >= b,)
}

/// Returns the remainder of the division of `a` by `b`, truncated towards 0; `None` only for `b` = 0. The remainder by
/// -1 is always 0, also where the quotient overflows.
pub(super) fn remainder(a: i64, b: i64) -> Option<i64> {
    (b != 0).then(|| a.wrapping_rem(b))
}

pub(super) fn power(base: i64, exponent: i64) -> Option<i64> {
    // For exponents above 63, only the powers of 0, 1 and -1 fit, and they depend only on the parity of the exponent.
    let exponent = if exponent > 64 {
        64 + exponent % 2
    } else {
        exponent
    };
    base.checked_pow(u32::try_from(exponent).ok()?)
}
