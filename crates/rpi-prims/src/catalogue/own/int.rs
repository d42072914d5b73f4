//! Operators on 64-bit integers. A result that does not fit is a fault, never a wrapped value.

use crate::catalogue::int::{divided, fits};
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
    /// Difference of two integers.
    SUBTRACT = "Rpi::IntSubtract";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: i64 }
    presence strict work 1 faults;
    full |cx, place, _, _, (a, b)| (fits(cx, place, i64::checked_sub(a, b)),)
}

primitive! {
    /// The integer of opposite sign.
    NEGATE = "Rpi::IntNegate";
    in { inValue: i64 = Value(Int(0)) }
    out { outValue: i64 }
    presence strict work 1 faults;
    full |cx, place, _, _, (a,)| (fits(cx, place, i64::checked_neg(a)),)
}

primitive! {
    /// Remainder of the division truncated towards 0: it has the sign of the first operand, as in C. By zero it is a fault.
    MODULO = "Rpi::IntModulo";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(1)) }
    out { outValue: i64 }
    presence strict work 10 faults;
    full |cx, place, _, _, (a, b)| (divided(cx, place, b, remainder(a, b)),)
}

primitive! {
    /// The first operand to the power of the second, which must not be negative.
    POWER = "Rpi::IntPower";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(1)) }
    out { outValue: i64 }
    presence strict work 64 faults;
    full |cx, place, _, _, (a, b)| (fits(cx, place, power(a, b)),)
}

primitive! {
    /// Size without sign.
    ABSOLUTE = "Rpi::IntAbsolute";
    in { inValue: i64 = Value(Int(0)) }
    out { outValue: i64 }
    presence strict work 1 faults;
    full |cx, place, _, _, (a,)| (fits(cx, place, i64::checked_abs(a)),)
}

primitive! {
    /// The smaller of two integers.
    MINIMUM = "Rpi::IntMinimum";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: i64 }
    presence strict work 1;
    pure |(a, b): (i64, i64)| (a.min(b),)
}

primitive! {
    /// The greater of two integers.
    MAXIMUM = "Rpi::IntMaximum";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: i64 }
    presence strict work 1;
    pure |(a, b): (i64, i64)| (a.max(b),)
}

primitive! {
    /// True if the first operand is not less than the second.
    GREATER_OR_EQUAL = "Rpi::IntGreaterOrEqual";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: bool }
    presence strict work 1;
    pure |(a, b): (i64, i64)| (a >= b,)
}

/// None for the divisor 0 alone: the remainder by -1 fits where the quotient does not.
pub(super) fn remainder(a: i64, b: i64) -> Option<i64> {
    (b != 0).then(|| a.wrapping_rem(b))
}

pub(super) fn power(base: i64, exponent: i64) -> Option<i64> {
    // Beyond 63 only 0, 1 and -1 have a power that fits; their powers depend on the parity alone.
    let exponent = if exponent > 64 {
        64 + exponent % 2
    } else {
        exponent
    };
    base.checked_pow(u32::try_from(exponent).ok()?)
}
