//! Expressions for the activation and reset of fragments.

use super::observed_flow::{ObservedFlow, PresenceCondition};
use crate::net::FragmentId;

/// Lustre expressions that are true while a fragment is active (`None`: always) and while its state is reset (`None`:
/// never).
#[derive(Clone, Default)]
pub(super) struct FragmentActivation {
    pub(super) active: Option<String>,
    pub(super) reset: Option<String>,
}

/// Table of the activation and reset expressions of all fragments, by fragment index.
pub(super) struct FragmentActivations {
    fragments: Vec<FragmentActivation>,
}

impl FragmentActivations {
    /// Creates the table for a net with this number of fragments. At first, each fragment is always active and never
    /// reset.
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

    /// Returns the condition under which a fragment is active.
    pub(super) fn active(&self, fragment: FragmentId) -> PresenceCondition {
        let on = self.fragments[fragment.index()].active.clone();
        on.map_or(PresenceCondition::Always, |on| {
            PresenceCondition::While(vec![on])
        })
    }

    /// Returns a Lustre expression that is true unless the fragment is active and the condition is present and false.
    /// `None` if the condition has no Lustre form.
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
