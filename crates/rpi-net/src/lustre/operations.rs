//! Operations on optional flows that are not strict: their value and presence as Lustre expressions of the operands.

use super::observed_flow::{ObservedFlow, PresenceCondition};

/// Lustre expressions for the value and presence of a flow, from which its equation is written.
pub(super) struct Equation {
    pub(super) value: String,
    pub(super) presence: PresenceCondition,
}

impl Equation {
    /// Creates the equation of a flow that is present in every cycle.
    pub(super) fn always_present(value: String) -> Equation {
        Equation {
            value,
            presence: PresenceCondition::Always,
        }
    }
}

/// Returns the equation of `and`, `or` or `=>` (which is `not a or b`) in strong Kleene logic: one operand may decide
/// the result while the other is absent. `None` unless there are two operands with Lustre forms.
pub(super) fn kleene(operands: &[ObservedFlow], op: &str) -> Option<Equation> {
    let [a, b] = operands else {
        return None;
    };
    let (x, y) = (a.value.clone()?, b.value.clone()?);
    let both = a.presence.and(&b.presence);
    if both == PresenceCondition::Always {
        let value = format!("{x} {op} {y}");
        return Some(Equation {
            value,
            presence: both,
        });
    }
    let (x, op) = match op {
        "=>" => (format!("(not {x})"), "or"),
        _ => (x, op),
    };
    // An absent operand counts as the neutral element, which does not decide.
    let neutral = |value: &str, is: &PresenceCondition| match op {
        "and" => format!("(not {} or {value})", is.text()),
        _ => format!("({} and {value})", is.text()),
    };
    let decides = |value: &str, is: &PresenceCondition| match op {
        "and" => format!("({} and not {value})", is.text()),
        _ => format!("({} and {value})", is.text()),
    };
    let value = format!(
        "{} {op} {}",
        neutral(&x, &a.presence),
        neutral(&y, &b.presence)
    );
    let [by_x, by_y] = [decides(&x, &a.presence), decides(&y, &b.presence)];
    let any = format!("({} or {by_x} or {by_y})", both.text());
    let is = PresenceCondition::While(vec![any]);
    Some(Equation {
        value,
        presence: is,
    })
}

/// Returns the equation of `if c then x else y`. The operand that is not selected may be absent.
pub(super) fn conditional(operands: &[ObservedFlow]) -> Option<Equation> {
    let [condition, yes, no] = operands else {
        return None;
    };
    let (c, a, b) = (
        condition.value.clone()?,
        yes.value.clone()?,
        no.value.clone()?,
    );
    let chosen = match (&yes.presence, &no.presence) {
        (a, b) if a == b => a.clone(),
        (a, b) => PresenceCondition::While(vec![format!(
            "(if {c} then {} else {})",
            a.text(),
            b.text()
        )]),
    };
    Some(Equation {
        value: format!("if {c} then {a} else {b}"),
        presence: condition.presence.and(&chosen),
    })
}

/// Returns the equation of `x ?? y`: the first operand where it is present, otherwise the second.
pub(super) fn coalesce(operands: &[ObservedFlow]) -> Option<Equation> {
    let [first, second] = operands else {
        return None;
    };
    let (a, b) = (first.value.clone()?, second.value.clone()?);
    Some(match (&first.presence, &second.presence) {
        (PresenceCondition::Always, _) => Equation {
            value: a,
            presence: PresenceCondition::Always,
        },
        (PresenceCondition::Never, is) => Equation {
            value: b,
            presence: is.clone(),
        },
        (is, other) => Equation {
            value: format!("if {} then {a} else {b}", is.text()),
            presence: match other {
                PresenceCondition::Always => PresenceCondition::Always,
                other => {
                    PresenceCondition::While(vec![format!("({} or {})", is.text(), other.text())])
                }
            },
        },
    })
}

/// Returns the equation of the first operand, made absent in cycles in which the second operand is true or absent.
pub(super) fn set_null(operands: &[ObservedFlow]) -> Option<Equation> {
    let [operand, null] = operands else {
        return None;
    };
    let kept = PresenceCondition::While(vec![format!("(not {})", null.value.clone()?)]);
    Some(Equation {
        value: operand.value.clone()?,
        presence: operand.presence.and(&null.presence).and(&kept),
    })
}
