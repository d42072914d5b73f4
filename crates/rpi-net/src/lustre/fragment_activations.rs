//! Expressions for the activation and reset of fragments.

use super::observed_flow::{ObservedFlow, PresenceCondition};
use crate::net::FragmentId;

/// Lustre expressions for the activation of a fragment (`None`: always active) and for its reset (`None`: never).
#[derive(Clone, Default)]
pub(super) struct FragmentActivation {
    pub(super) active: Option<String>,
    pub(super) reset: Option<String>,
}

/// Activation and reset expressions of the fragments that have been translated.
pub(super) struct FragmentActivations {
    fragments: Vec<FragmentActivation>,
}

impl FragmentActivations {
    /// Creates the table for a net with this number of fragments; at first all are always active and never reset.
    pub(super) fn new(fragments: usize) -> Self {
        FragmentActivations {
            fragments: vec![FragmentActivation::default(); fragments],
        }
    }

    pub(super) fn get(&self, fragment: FragmentId) -> &FragmentActivation {
        &self.fragments[fragment.index()]
    }

    pub(super) fn set(&mut self, fragment: FragmentId, activation: FragmentActivation) {
        self.fragments[fragment.index()] = activation;
    }

    /// Condition under which a fragment is active.
    pub(super) fn active(&self, fragment: FragmentId) -> PresenceCondition {
        let on = self.fragments[fragment.index()].active.clone();
        on.map_or(PresenceCondition::Always, |on| {
            PresenceCondition::While(vec![on])
        })
    }

    /// Expression that is true if a condition holds wherever it is present and its fragment is active.
    pub(super) fn guarded_condition(
        &self,
        fragment: FragmentId,
        condition: &ObservedFlow,
    ) -> Option<String> {
        let value = condition.value.clone()?;
        Some(match self.active(fragment).and(&condition.presence) {
            PresenceCondition::Always => value,
            is => format!("({} => {value})", is.text()),
        })
    }
}
