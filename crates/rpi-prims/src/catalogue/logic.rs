//! Boolean logic. It is three-valued if an operand may be absent (Kleene, 1952).

use crate::macros::primitive;
use crate::registry::Prim;

pub(super) const ALL: &[Prim] = &[AND, OR, NOT];

primitive! {
    /// Conjunction (Kleene). False if an operand is false, even if the other one is absent; otherwise absent if an
    /// operand is absent.
    AND = "Core::BooleanAnd";
    in { inFirst: bool = First(Bool(true)); inSecond: bool = Second(Bool(true)) }
    out { outValue: bool }
    presence if_all work 1;
    c Both("inFirst && inSecond", r"
const bool is_false = (inFirst_present && !inFirst) || (inSecond_present && !inSecond);
*outValue_present = is_false || (inFirst_present && inSecond_present);
if (*outValue_present) {
  *outValue = !is_false;
}
");
    pure |(a, b)| (match (a, b) {
        (Some(false), _) | (_, Some(false)) => Some(false),
        (Some(true), Some(true)) => Some(true),
        _ => None,
    },)
}

primitive! {
    /// Disjunction (Kleene). True if an operand is true, even if the other one is absent; otherwise absent if an
    /// operand is absent.
    OR = "Core::BooleanOr";
    in { inFirst: bool = First(Bool(false)); inSecond: bool = Second(Bool(false)) }
    out { outValue: bool }
    presence if_all work 1;
    c Both("inFirst || inSecond", r"
const bool is_true = (inFirst_present && inFirst) || (inSecond_present && inSecond);
*outValue_present = is_true || (inFirst_present && inSecond_present);
if (*outValue_present) {
  *outValue = is_true;
}
");
    pure |(a, b)| (match (a, b) {
        (Some(true), _) | (_, Some(true)) => Some(true),
        (Some(false), Some(false)) => Some(false),
        _ => None,
    },)
}

primitive! {
    /// Negation of a Boolean: true if the operand is false.
    NOT = "Core::BooleanNot";
    in { inValue: bool = Value(Bool(false)) }
    out { outValue: bool }
    presence strict work 1;
    c Value("!inValue");
    pure |(a,)| (!a,)
}
