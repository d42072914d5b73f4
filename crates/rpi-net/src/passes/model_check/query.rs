//! Queries: combinations of events to look for in one cycle of a command.

use super::cone::Cone;
use super::cycle::Cycle;
use super::domain::Domain;
use crate::net::{Input, Net, PortRef, ResultKind, Termination};
use crate::passes::fact_prover::Event;

/// Condition on one cycle. The model checker decides whether any cycle of the command satisfies it.
#[derive(Clone, Debug)]
pub(super) enum Query {
    /// Both events occur in the same cycle.
    Both([Event; 2]),
    /// None of these events occurs in the cycle.
    Neither(Vec<Event>),
}

impl Query {
    /// Returns the events that the condition is about.
    pub(super) fn events(&self) -> &[Event] {
        match self {
            Query::Both(both) => both,
            Query::Neither(all) => all,
        }
    }

    /// Returns whether the cycle satisfies the condition.
    pub(super) fn is_satisfied<D: Domain>(&self, cycle: &mut Cycle<'_, D>) -> D::Bool {
        let mut is = cycle.domain.bit(true);
        for event in self.events() {
            let happens = cycle.occurs(event);
            let required = match self {
                Query::Both(_) => happens,
                Query::Neither(_) => cycle.domain.not(happens),
            };
            is = cycle.domain.and(is, required);
        }
        is
    }
}

/// Input of the model checker: queries, and the part of the net that decides them.
pub(super) struct Problem<'a> {
    pub(super) cone: Cone<'a>,
    pub(super) events: Vec<Query>,
    /// Flows each of which ends the command in a cycle in which it is true.
    pub(super) ends: Vec<PortRef>,
    /// Whether the command always ends in its first cycle.
    pub(super) ends_at_once: bool,
}

/// Returns the conditions each of which ends a command on its own. The condition of a `yield` is not among them, since
/// it also needs a successor.
pub(super) fn ends(net: &Net) -> Vec<PortRef> {
    let Termination::Results(results) = &net.termination else {
        return Vec::new();
    };
    let sure = results
        .iter()
        .filter(|result| result.kind != ResultKind::Yield);
    sure.filter_map(|result| result.condition.port()).collect()
}

/// Returns whether a command always ends in its first cycle, because the condition of a result is constantly true.
pub(super) fn ends_at_once(net: &Net) -> bool {
    let Termination::Results(results) = &net.termination else {
        return false;
    };
    results.iter().any(|result| {
        let is_sure = result.kind != ResultKind::Yield;
        is_sure && matches!(&result.condition, Input::Const(value) if value.as_bool() == Some(true))
    })
}
