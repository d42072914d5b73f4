//! Value and presence of a flow as Lustre expressions.

use crate::net::AbsentPolicy;

/// Lustre expressions for the value and presence of a flow as one of its readers sees it.
pub(super) struct ObservedFlow {
    /// Expression of the value; `None` for a type without Lustre equivalent.
    pub(super) value: Option<String>,
    /// Condition under which the flow is present.
    pub(super) presence: PresenceCondition,
}

impl ObservedFlow {
    /// Returns a Lustre expression that is true if the Boolean flow is true. `absent` decides its value in cycles in
    /// which the flow is absent.
    pub(super) fn holds(&self, absent: AbsentPolicy) -> String {
        let value = self.value.as_deref().unwrap_or("false");
        match (&self.presence, absent) {
            (PresenceCondition::Always, _) => value.to_owned(),
            (is, AbsentPolicy::Inactive) => format!("({} and {value})", is.text()),
            (is, AbsentPolicy::Active) => format!("(not {} or {value})", is.text()),
        }
    }
}

/// Condition under which a flow has a value in a cycle.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum PresenceCondition {
    Always,
    Never,
    /// The flow is present while all these Lustre expressions are true.
    While(Vec<String>),
}

impl PresenceCondition {
    /// Returns the condition that holds if both conditions do.
    pub(super) fn and(&self, other: &PresenceCondition) -> PresenceCondition {
        match (self, other) {
            (PresenceCondition::Never, _) | (_, PresenceCondition::Never) => {
                PresenceCondition::Never
            }
            (PresenceCondition::Always, is) | (is, PresenceCondition::Always) => is.clone(),
            (PresenceCondition::While(a), PresenceCondition::While(b)) => {
                let fresh = b.iter().filter(|condition| !a.contains(condition));
                PresenceCondition::While(a.iter().chain(fresh).cloned().collect())
            }
        }
    }

    /// Returns the condition that holds if `self` does or the Lustre expression is true.
    pub(super) fn or(&self, expression: &str) -> PresenceCondition {
        match self {
            PresenceCondition::Always => PresenceCondition::Always,
            _ => PresenceCondition::While(vec![format!("({expression} or {})", self.text())]),
        }
    }

    /// Returns the condition as a Lustre expression, in parentheses where needed.
    pub(super) fn text(&self) -> String {
        match self {
            PresenceCondition::Always => "true".to_owned(),
            PresenceCondition::Never => "false".to_owned(),
            PresenceCondition::While(all) => match &all[..] {
                [one] => one.clone(),
                all => format!("({})", all.join(" and ")),
            },
        }
    }
}
