//! Integer operations in a branch of an `if`: they count, and can fault, only in cycles in which the branch is chosen.
//! Otherwise they give 0, which nobody reads.

use crate::catalogue::int::{divided, fits, whole};
use crate::catalogue::own::int::{power, remainder};
use crate::catalogue::own::ticks::ticks;
use crate::cx::FaultCode;
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

/// A binary operation and, in its own words, what it gives.
macro_rules! binary {
    ($id:ident, $name:literal, $what:literal, $work:literal, $second:literal, |$cx:ident, $place:ident, $a:ident, $b:ident| $result:expr) => {
        primitive! {
            #[doc = concat!($what, " where `inActive` is true; else 0, without a fault.")]
            $id = concat!("Rpi::GuardedInt", $name);
            in { inActive: bool; inFirst: i64 = First(Int(0)); inSecond: i64 = Second(Int($second)) }
            out { outValue: i64 }
            presence strict work $work faults;
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
    |cx, place, a, b| fits(cx, place, a.checked_add(b))
);
binary!(
    SUBTRACT,
    "Subtract",
    "Difference of two integers",
    1,
    0,
    |cx, place, a, b| fits(cx, place, a.checked_sub(b))
);
binary!(
    MULTIPLY,
    "Multiply",
    "Product of two integers",
    1,
    0,
    |cx, place, a, b| fits(cx, place, a.checked_mul(b))
);
binary!(
    DIVIDE,
    "Divide",
    "Quotient of two integers, truncated towards 0,",
    10,
    1,
    |cx, place, a, b| divided(cx, place, b, a.checked_div(b))
);
binary!(
    MODULO,
    "Modulo",
    "Remainder of the truncated division",
    10,
    1,
    |cx, place, a, b| divided(cx, place, b, remainder(a, b))
);
binary!(
    POWER,
    "Power",
    "The first integer to the power of the second",
    64,
    1,
    |cx, place, a, b| fits(cx, place, power(a, b))
);

/// An operation on one value.
macro_rules! unary {
    ($id:ident, $name:literal, $what:literal, $t:ty, |$cx:ident, $place:ident, $a:ident| $result:expr) => {
        primitive! {
            #[doc = concat!($what, " where `inActive` is true; else 0, without a fault.")]
            $id = concat!("Rpi::GuardedInt", $name);
            in { inActive: bool; inValue: $t = Value(Neutral) }
            out { outValue: i64 }
            presence strict work 1 faults;
            full |$cx, $place, _, _, (active, $a): (bool, $t)| (if active { $result } else { 0 },)
        }
    };
}

unary!(
    NEGATE,
    "Negate",
    "The integer of opposite sign",
    i64,
    |cx, place, a| fits(cx, place, a.checked_neg())
);
unary!(
    ABSOLUTE,
    "Absolute",
    "Size without sign",
    i64,
    |cx, place, a| fits(cx, place, a.checked_abs())
);
unary!(
    INT_FROM_DOUBLE,
    "FromDouble",
    "A real without its fraction",
    f64,
    |cx, place, a| whole(cx, place, a)
);

primitive! {
    /// Lets an integer through; where `inActive` is true one below `inFrom` or above `inTo` is a fault, which ends the
    /// command.
    INT_WITHIN = "Rpi::IntWithin";
    in { inActive: bool; inValue: i64 = Value(Int(0)); inFrom: i64 = From(Int(i64::MIN)); inTo: i64 = To(Int(i64::MAX)) }
    out { outValue: i64 }
    presence strict work 2 faults;
    full |cx, place, _, _, (active, value, from, to): (bool, i64, i64, i64)| {
        if active && !(from..=to).contains(&value) {
            cx.fault(FaultCode::OutsideSubrange, place);
        }
        (value,)
    }
}

primitive! {
    /// The fewest whole ticks that take at least so many seconds where `inActive` is true; else 0, without a fault.
    TICKS_FROM_SECONDS = "Rpi::GuardedTicksFromSeconds";
    in { inActive: bool; inValue: f64 }
    out { outValue: i64 }
    presence strict work 10 faults;
    full |cx, place, _, _, (active, seconds): (bool, f64)| (if active { ticks(cx, place, seconds) } else { 0 },)
}
