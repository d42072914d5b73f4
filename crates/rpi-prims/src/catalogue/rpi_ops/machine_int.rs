//! Operators on the machine integers of Kind 2, which have a width and wrap around: results are taken modulo 2 to the
//! power of the width. Division and shifts are those of the SMT-LIB theory of bit vectors, which Kind 2 uses.
//!
//! A value is stored in 64 bits, sign-extended if it is signed and zero-extended if it is unsigned. `inWidth` is the
//! width in bits, 1 to 64; it is negative for signed integers.

use crate::catalogue::int::or_overflow_fault;
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
    /// Machine integer with the least significant bits of a number. `inWidth` is the width in bits, negative for signed
    /// integers.
    WRAP = "Rpi::MachineWrap";
    in { inValue: i64 = Value(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 2;
    c Value("rpi_wrap(inValue, inWidth)");
    pure |(a, width): (i64, i64)| (wrap(a, width),)
}

primitive! {
    /// Sum of two machine integers, wrapped to the width.
    ADD = "Rpi::MachineAdd";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 3;
    c Value("rpi_wrap(rpi_integer((uint64_t)inFirst + (uint64_t)inSecond), inWidth)");
    pure |(a, b, width): (i64, i64, i64)| (wrap(a.wrapping_add(b), width),)
}

primitive! {
    /// Difference of two machine integers, wrapped to the width.
    SUBTRACT = "Rpi::MachineSubtract";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 3;
    c Value("rpi_wrap(rpi_integer((uint64_t)inFirst - (uint64_t)inSecond), inWidth)");
    pure |(a, b, width): (i64, i64, i64)| (wrap(a.wrapping_sub(b), width),)
}

primitive! {
    /// Product of two machine integers, wrapped to the width.
    MULTIPLY = "Rpi::MachineMultiply";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(1)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 4;
    c Value("rpi_wrap(rpi_integer((uint64_t)inFirst * (uint64_t)inSecond), inWidth)");
    pure |(a, b, width): (i64, i64, i64)| (wrap(a.wrapping_mul(b), width),)
}

primitive! {
    /// Quotient of two machine integers, truncated towards 0. Division by zero gives all bits set, or 1 for a negative
    /// first operand.
    DIVIDE = "Rpi::MachineDivide";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(1)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 10;
    c Value("rpi_machine_divide(inFirst, inSecond, inWidth)");
    pure |(a, b, width): (i64, i64, i64)| (quotient(a, b, width),)
}

primitive! {
    /// Remainder of two machine integers, with the sign of the first operand. Division by zero gives the first operand.
    MODULO = "Rpi::MachineModulo";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(1)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 10;
    c Value("rpi_machine_modulo(inFirst, inSecond, inWidth)");
    pure |(a, b, width): (i64, i64, i64)| (remainder(a, b, width),)
}

primitive! {
    /// Bitwise AND of two machine integers.
    AND = "Rpi::MachineAnd";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: i64 }
    presence strict work 1;
    c Value("rpi_integer((uint64_t)inFirst & (uint64_t)inSecond)");
    pure |(a, b): (i64, i64)| (a & b,)
}

primitive! {
    /// Bitwise OR of two machine integers.
    OR = "Rpi::MachineOr";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)) }
    out { outValue: i64 }
    presence strict work 1;
    c Value("rpi_integer((uint64_t)inFirst | (uint64_t)inSecond)");
    pure |(a, b): (i64, i64)| (a | b,)
}

primitive! {
    /// Bitwise NOT of a machine integer.
    NOT = "Rpi::MachineNot";
    in { inValue: i64 = Value(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 2;
    c Value("rpi_wrap(rpi_integer(~(uint64_t)inValue), inWidth)");
    pure |(a, width): (i64, i64)| (wrap(!a, width),)
}

primitive! {
    /// Left shift of the first operand by the second, which is unsigned.
    SHIFT_LEFT = "Rpi::MachineShiftLeft";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 3;
    c Value("rpi_shift_left(inFirst, inSecond, inWidth)");
    pure |(a, b, width): (i64, i64, i64)| (wrap(a.checked_shl(shift_amount(b)).unwrap_or(0), width),)
}

primitive! {
    /// Right shift of the first operand by the second, which is unsigned. The shift is arithmetic for signed integers
    /// and logical for unsigned ones.
    SHIFT_RIGHT = "Rpi::MachineShiftRight";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 3;
    c Value("rpi_shift_right(inFirst, inSecond, inWidth)");
    pure |(a, b, width): (i64, i64, i64)| (shifted_right(a, b, width),)
}

primitive! {
    /// True if the first machine integer is greater than the second.
    GREATER = "Rpi::MachineGreater";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: bool }
    presence strict work 2;
    c Value("inWidth < 0 ? inFirst > inSecond : (uint64_t)inFirst > (uint64_t)inSecond");
    pure |(a, b, width): (i64, i64, i64)| (order(a, b, width).is_gt(),)
}

primitive! {
    /// True if the first machine integer is greater than or equal to the second.
    GREATER_OR_EQUAL = "Rpi::MachineGreaterOrEqual";
    in { inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: bool }
    presence strict work 2;
    c Value("inWidth < 0 ? inFirst >= inSecond : (uint64_t)inFirst >= (uint64_t)inSecond");
    pure |(a, b, width): (i64, i64, i64)| (order(a, b, width).is_ge(),)
}

primitive! {
    /// Integer from a machine integer. An unsigned 64-bit value above the maximum integer is a fault.
    TO_INT = "Rpi::MachineToInt";
    in { inValue: i64 = Value(Int(0)); inWidth: i64 = Width(Int(-64)) }
    out { outValue: i64 }
    presence strict work 1 faults;
    c Code(r"
if (inWidth >= 0 && inValue < 0) {
  rpi_fault(cx, RPI_INTEGER_OVERFLOW, at);
  *outValue = 0;
} else {
  *outValue = inValue;
}
");
    full |cx, place, _, _, (a, width)| (or_overflow_fault(cx, place, (width < 0 || a >= 0).then_some(a)),)
}

/// Returns the integer with the least significant bits of `value`, as many as the magnitude of `width`: sign-extended
/// to 64 bits if `width` is negative (a signed type), else zero-extended.
fn wrap(value: i64, width: i64) -> i64 {
    let above = 64 - width.unsigned_abs().clamp(1, 64) as u32;
    match width < 0 {
        true => (value << above) >> above,
        false => ((value << above).cast_unsigned() >> above).cast_signed(),
    }
}

fn quotient(a: i64, b: i64, width: i64) -> i64 {
    let (ua, ub) = (a.cast_unsigned(), b.cast_unsigned());
    let quotient = match (width < 0, b) {
        // SMT-LIB: division by zero gives all bits set (`bvudiv`), or 1 and -1 by the sign of the dividend (`bvsdiv`).
        (true, 0) if a < 0 => 1,
        (_, 0) => -1,
        (true, _) => a.wrapping_div(b),
        (false, _) => (ua / ub).cast_signed(),
    };
    wrap(quotient, width)
}

fn remainder(a: i64, b: i64, width: i64) -> i64 {
    match (width < 0, b) {
        (_, 0) => a,
        (true, _) => a.wrapping_rem(b),
        (false, _) => (a.cast_unsigned() % b.cast_unsigned()).cast_signed(),
    }
}

/// Returns the number of bits to shift by, for the operand `by`. Negative values, which are large unsigned ones, become
/// 64, which shifts out all bits.
fn shift_amount(by: i64) -> u32 {
    u32::try_from(by).unwrap_or(64)
}

fn shifted_right(a: i64, by: i64, width: i64) -> i64 {
    match width < 0 {
        true => a >> shift_amount(by).min(63),
        false => {
            let shifted = a.cast_unsigned().checked_shr(shift_amount(by));
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
