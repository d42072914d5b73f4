//! Queries: combinations of events to look for in one cycle of a command.

use super::cone::Cone;
use super::cycle::Cycle;
use super::domain::Domain;
use crate::net::{Input, Net, PortRef, ResultKind, Termination};
use crate::passes::fact_prover::Event;

/// Condition on one cycle, about which the model checker decides whether it can be satisfied.
#[derive(Clone, Debug)]
pub(super) enum Query {
    /// Both events occur.
    Both([Event; 2]),
    /// None of these events occurs.
    Neither(Vec<Event>),
}

impl Query {
    /// Events that the condition is about.
    pub(super) fn events(&self) -> &[Event] {
        match self {
            Query::Both(both) => both,
            Query::Neither(all) => all,
        }
    }

    /// Whether a cycle satisfies the condition.
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

/// Queries with the part of the net that decides them, as the model checker solves them.
pub(super) struct Problem<'a> {
    pub(super) cone: Cone<'a>,
    pub(super) events: Vec<Query>,
    /// Flows that end the command when one of them is true, so that no further cycle follows.
    pub(super) ends: Vec<PortRef>,
    /// Whether the command always ends in its first cycle.
    pub(super) ends_at_once: bool,
}

/// Conditions each of which ends a command on its own. A `yield` is not among them, since it needs a successor.
pub(super) fn ends(net: &Net) -> Vec<PortRef> {
    let Termination::Results(results) = &net.termination else {
        return Vec::new();
    };
    let sure = results
        .iter()
        .filter(|result| result.kind != ResultKind::Yield);
    sure.filter_map(|result| result.condition.port()).collect()
}

/// Whether a command always ends in its first cycle.
pub(super) fn ends_at_once(net: &Net) -> bool {
    let Termination::Results(results) = &net.termination else {
        return false;
    };
    results.iter().any(|result| {
        let is_sure = result.kind != ResultKind::Yield;
        is_sure && matches!(&result.condition, Input::Const(value) if value.as_bool() == Some(true))
    })
}
