//! Boolean operators that the reference system composes from others.

use crate::macros::primitive;
use crate::registry::Prim;

pub(in crate::catalogue) const ALL: &[Prim] = &[XOR, IMPLIES, EQUALS];

primitive! {
    /// True if exactly one operand is true.
    XOR = "Rpi::BooleanXor";
    in { inFirst: bool = First(Bool(false)); inSecond: bool = Second(Bool(false)) }
    out { outValue: bool }
    presence strict work 1;
    c Value("inFirst != inSecond");
    pure |(a, b): (bool, bool)| (a ^ b,)
}

primitive! {
    /// Implication: false only if the first operand is true and the second one is false. Three-valued like `not first
    /// or second`.
    IMPLIES = "Rpi::BooleanImplies";
    in { inFirst: bool = First(Bool(false)); inSecond: bool = Second(Bool(false)) }
    out { outValue: bool }
    presence if_all work 1;
    c Both("!inFirst || inSecond", r"
const bool is_true = (inFirst_present && !inFirst) || (inSecond_present && inSecond);
*outValue_present = is_true || (inFirst_present && inSecond_present);
if (*outValue_present) {
  *outValue = is_true;
}
");
    pure |(a, b)| (match (a, b) {
        (Some(false), _) | (_, Some(true)) => Some(true),
        (Some(true), Some(false)) => Some(false),
        _ => None,
    },)
}

primitive! {
    /// True if both operands are equal.
    EQUALS = "Rpi::BooleanEquals";
    in { inFirst: bool = First(Bool(false)); inSecond: bool = Second(Bool(false)) }
    out { outValue: bool }
    presence strict work 1;
    c Value("inFirst == inSecond");
    pure |(a, b): (bool, bool)| (a == b,)
}
