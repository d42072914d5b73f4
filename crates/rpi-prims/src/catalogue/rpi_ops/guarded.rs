//! Integer operations in a branch of an `if`. They can fault only in cycles in which the branch is selected. Otherwise
//! they output 0, which is not used.

use crate::catalogue::int::{or_division_fault, or_overflow_fault, truncate_or_fault};
use crate::catalogue::rpi_ops::int::{power, remainder};
use crate::catalogue::rpi_ops::ticks::ticks_or_fault;
use crate::context::{FaultCode, FaultValues};
use crate::macros::primitive;
use crate::registry::Prim;

pub(in crate::catalogue) const ALL: &[Prim] = &[
    ADD,
    SUBTRACT,
    MULTIPLY,
    DIVIDE,
    MODULO,
    POWER,
    NEGATE,
    ABSOLUTE,
    INT_FROM_DOUBLE,
    TICKS_FROM_SECONDS,
    INT_WITHIN,
];

/// Defines a primitive with two integer operands that computes only while its in-port `inActive` is true. `$what` is
/// the start of its documentation.
macro_rules! binary {
    ($id:ident, $name:literal, $what:literal, $work:literal, $second:literal, $c:literal, |$cx:ident, $place:ident, $a:ident, $b:ident| $result:expr) => {
        primitive! {
            #[doc = concat!($what, " if `inActive` is true; else 0 without a fault.")]
            $id = concat!("Rpi::GuardedInt", $name);
            in { inActive: bool; inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int($second)) }
            out { outValue: i64 }
            presence strict work $work faults;
            c Value(concat!("inActive ? ", $c, " : 0"));
            full |$cx, $place, _, _, (active, $a, $b): (bool, i64, i64)| (if active { $result } else { 0 },)
        }
    };
}

binary!(
    ADD,
    "Add",
    "Sum of two integers",
    1,
    0,
    "rpi_int_add(cx, at, inFirst, inSecond)",
    |cx, place, a, b| or_overflow_fault(cx, place, a.checked_add(b))
);
binary!(
    SUBTRACT,
    "Subtract",
    "Difference of two integers",
    1,
    0,
    "rpi_int_subtract(cx, at, inFirst, inSecond)",
    |cx, place, a, b| or_overflow_fault(cx, place, a.checked_sub(b))
);
binary!(
    MULTIPLY,
    "Multiply",
    "Product of two integers",
    1,
    0,
    "rpi_int_multiply(cx, at, inFirst, inSecond)",
    |cx, place, a, b| or_overflow_fault(cx, place, a.checked_mul(b))
);
binary!(
    DIVIDE,
    "Divide",
    "Quotient of two integers, truncated towards 0,",
    10,
    1,
    "rpi_int_divide(cx, at, inFirst, inSecond)",
    |cx, place, a, b| or_division_fault(cx, place, b, a.checked_div(b))
);
binary!(
    MODULO,
    "Modulo",
    "Remainder of the truncated division",
    10,
    1,
    "rpi_int_modulo(cx, at, inFirst, inSecond)",
    |cx, place, a, b| or_division_fault(cx, place, b, remainder(a, b))
);
binary!(
    POWER,
    "Power",
    "First integer to the power of the second",
    64,
    1,
    "rpi_int_power(cx, at, inFirst, inSecond)",
    |cx, place, a, b| or_overflow_fault(cx, place, power(a, b))
);

/// Defines a primitive with one operand that computes only while its in-port `inActive` is true. `$what` is the start
/// of its documentation.
macro_rules! unary {
    ($id:ident, $name:literal, $what:literal, $t:ty, $c:literal, |$cx:ident, $place:ident, $a:ident| $result:expr) => {
        primitive! {
            #[doc = concat!($what, " if `inActive` is true; else 0 without a fault.")]
            $id = concat!("Rpi::GuardedInt", $name);
            in { inActive: bool; inValue: $t = Value(Neutral) }
            out { outValue: i64 }
            presence strict work 1 faults;
            c Value(concat!("inActive ? ", $c, " : 0"));
            full |$cx, $place, _, _, (active, $a): (bool, $t)| (if active { $result } else { 0 },)
        }
    };
}

unary!(
    NEGATE,
    "Negate",
    "Negated integer",
    i64,
    "rpi_int_negate(cx, at, inValue)",
    |cx, place, a| or_overflow_fault(cx, place, a.checked_neg())
);
unary!(
    ABSOLUTE,
    "Absolute",
    "Absolute value",
    i64,
    "rpi_int_absolute(cx, at, inValue)",
    |cx, place, a| or_overflow_fault(cx, place, a.checked_abs())
);
unary!(
    INT_FROM_DOUBLE,
    "FromDouble",
    "Integer part of a real, truncated towards 0,",
    f64,
    "rpi_int_from_real(cx, at, inValue)",
    |cx, place, a| truncate_or_fault(cx, place, a)
);

primitive! {
    /// Outputs the integer. If `inActive` is true, a value below `inFrom` or above `inTo` is a fault, which ends the
    /// command.
    INT_WITHIN = "Rpi::IntWithin";
    in { inActive: bool; inValue: i64 = Value(Int(0)); inFrom: i64 = From(Int(i64::MIN)); inTo: i64 = To(Int(i64::MAX)) }
    out { outValue: i64 }
    presence strict work 2 faults;
    c Value("rpi_int_within(cx, at, inActive, inValue, inFrom, inTo)");
    full |cx, place, _, _, (active, value, from, to): (bool, i64, i64, i64)| {
        if active && !(from..=to).contains(&value) {
            cx.fault_by(FaultCode::OutsideSubrange, place, FaultValues::Range { value, from, to });
        }
        (value,)
    }
}

primitive! {
    /// Smallest whole number of ticks that is not shorter than the given time in s, if `inActive` is true; else 0
    /// without a fault. Not-a-number, infinities and values out of range are faults.
    TICKS_FROM_SECONDS = "Rpi::GuardedTicksFromSeconds";
    in { inActive: bool; inValue: f64 }
    out { outValue: i64 }
    presence strict work 10 faults;
    c Value("inActive ? rpi_ticks(cx, at, inValue) : 0");
    full |cx, place, _, _, (active, seconds): (bool, f64)| (if active { ticks_or_fault(cx, place, seconds) } else { 0 },)
}
