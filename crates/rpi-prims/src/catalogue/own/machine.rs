//! Operators on machine integers of Kind 2, which have a width and wrap around: results are taken modulo 2 to the power of the
//! width. Division and shifts are those of the theory of bit vectors of SMT-LIB, which Kind 2 uses.
//!
//! A value is kept in 64 bits: with its sign extended, or with zeros above its width. `inWidth` is the width in bits, from 1
//! to 64, negative for integers with a sign.

use crate::catalogue::int::fits;
use crate::macros::primitive;
use crate::registry::Prim;

pub(in crate::catalogue) const ALL: &[Prim] = &[
    WRAP,
    ADD,
    SUBTRACT,
    MULTIPLY,
    DIVIDE,
    MODULO,
    AND,
    OR,
    NOT,
    SHIFT_LEFT,
    SHIFT_RIGHT,
    GREATER,
    GREATER_OR_EQUAL,
    TO_INT,
];

primitive! {
    /// The machine integer with the lowest bits of a number.
    WRAP = "Rpi::MachineWrap";
    in { inValue: i64 = Value(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 2;
    pure |(a, width): (i64, i64)| (wrapped(a, width),)
}

primitive! {
    /// Sum of two machine integers.
    ADD = "Rpi::MachineAdd";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 3;
    pure |(a, b, width): (i64, i64, i64)| (wrapped(a.wrapping_add(b), width),)
}

primitive! {
    /// Difference of two machine integers.
    SUBTRACT = "Rpi::MachineSubtract";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 3;
    pure |(a, b, width): (i64, i64, i64)| (wrapped(a.wrapping_sub(b), width),)
}

primitive! {
    /// Product of two machine integers.
    MULTIPLY = "Rpi::MachineMultiply";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(1)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 4;
    pure |(a, b, width): (i64, i64, i64)| (wrapped(a.wrapping_mul(b), width),)
}

primitive! {
    /// Quotient of two machine integers, truncated towards 0. By zero it has all bits set, but is 1 for a negative number.
    DIVIDE = "Rpi::MachineDivide";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(1)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 10;
    pure |(a, b, width): (i64, i64, i64)| (quotient(a, b, width),)
}

primitive! {
    /// Remainder of two machine integers, with the sign of the first. By zero it is the first.
    MODULO = "Rpi::MachineModulo";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(1)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 10;
    pure |(a, b, width): (i64, i64, i64)| (remainder(a, b, width),)
}

primitive! {
    /// The bits that both machine integers have.
    AND = "Rpi::MachineAnd";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: i64 }
    presence strict work 1;
    pure |(a, b): (i64, i64)| (a & b,)
}

primitive! {
    /// The bits that one of two machine integers has.
    OR = "Rpi::MachineOr";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: i64 }
    presence strict work 1;
    pure |(a, b): (i64, i64)| (a | b,)
}

primitive! {
    /// A machine integer with every bit turned over.
    NOT = "Rpi::MachineNot";
    in { inValue: i64 = Value(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 2;
    pure |(a, width): (i64, i64)| (wrapped(!a, width),)
}

primitive! {
    /// The bits of the first operand, moved up by the second, which has no sign.
    SHIFT_LEFT = "Rpi::MachineShiftLeft";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 3;
    pure |(a, b, width): (i64, i64, i64)| (wrapped(a.checked_shl(places(b)).unwrap_or(0), width),)
}

primitive! {
    /// The bits of the first operand, moved down by the second, which has no sign. A sign fills the places that become free.
    SHIFT_RIGHT = "Rpi::MachineShiftRight";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 3;
    pure |(a, b, width): (i64, i64, i64)| (shifted_right(a, b, width),)
}

primitive! {
    /// True if the first machine integer is greater than the second.
    GREATER = "Rpi::MachineGreater";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: bool }
    presence strict work 2;
    pure |(a, b, width): (i64, i64, i64)| (order(a, b, width).is_gt(),)
}

primitive! {
    /// True if the first machine integer is not less than the second.
    GREATER_OR_EQUAL = "Rpi::MachineGreaterOrEqual";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: bool }
    presence strict work 2;
    pure |(a, b, width): (i64, i64, i64)| (order(a, b, width).is_ge(),)
}

primitive! {
    /// A machine integer as an integer. One of 64 bits without sign that is beyond the greatest integer is a fault.
    TO_INT = "Rpi::MachineToInt";
    in { inValue: i64 = Value(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 1 faults;
    full |cx, place, _, _, (a, width)| (fits(cx, place, (width < 0 || a >= 0).then_some(a)),)
}

/// The bits above the width, taken off; the sign extended if there is one.
fn wrapped(value: i64, width: i64) -> i64 {
    let above = 64 - width.unsigned_abs().clamp(1, 64) as u32;
    match width < 0 {
        true => (value << above) >> above,
        false => ((value << above).cast_unsigned() >> above).cast_signed(),
    }
}

fn quotient(a: i64, b: i64, width: i64) -> i64 {
    let (ua, ub) = (a.cast_unsigned(), b.cast_unsigned());
    let quotient = match (width < 0, b) {
        (true, 0) if a < 0 => 1,
        (_, 0) => -1,
        (true, _) => a.wrapping_div(b),
        (false, _) => (ua / ub).cast_signed(),
    };
    wrapped(quotient, width)
}

fn remainder(a: i64, b: i64, width: i64) -> i64 {
    match (width < 0, b) {
        (_, 0) => a,
        (true, _) => a.wrapping_rem(b),
        (false, _) => (a.cast_unsigned() % b.cast_unsigned()).cast_signed(),
    }
}

/// How many places to shift by; 64 and more leave nothing.
fn places(by: i64) -> u32 {
    u32::try_from(by).unwrap_or(64)
}

fn shifted_right(a: i64, by: i64, width: i64) -> i64 {
    match width < 0 {
        true => a >> places(by).min(63),
        false => {
            let shifted = a.cast_unsigned().checked_shr(places(by));
            shifted.unwrap_or(0).cast_signed()
        }
    }
}

fn order(a: i64, b: i64, width: i64) -> core::cmp::Ordering {
    match width < 0 {
        true => a.cmp(&b),
        false => a.cast_unsigned().cmp(&b.cast_unsigned()),
    }
}
