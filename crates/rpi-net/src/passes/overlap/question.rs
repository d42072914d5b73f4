//! Queries: combinations of events to look for in one cycle of a command.

use super::cone::Cone;
use super::cycle::Cycle;
use super::domain::Domain;
use crate::net::{Driver, Input, Net, PortRef, ResultKind};
use crate::passes::proof::Happening;

/// Condition on a cycle.
#[derive(Clone, Debug)]
pub(super) enum Event {
    /// Both events occur.
    Both([Happening; 2]),
    /// None of these events occurs.
    Neither(Vec<Happening>),
}

impl Event {
    /// Events of the condition.
    pub(super) fn happenings(&self) -> &[Happening] {
        match self {
            Event::Both(both) => both,
            Event::Neither(all) => all,
        }
    }

    /// Whether a cycle satisfies the condition.
    pub(super) fn is<D: Domain>(&self, cycle: &mut Cycle<'_, D>) -> D::Bit {
        let mut is = cycle.domain.bit(true);
        for happening in self.happenings() {
            let happens = cycle.happens(happening);
            let wanted = match self {
                Event::Both(_) => happens,
                Event::Neither(_) => cycle.domain.not(happens),
            };
            is = cycle.domain.and(is, wanted);
        }
        is
    }
}

/// Queries with the part of the net that decides them.
pub(super) struct Question<'a> {
    pub(super) cone: Cone<'a>,
    pub(super) events: Vec<Event>,
    /// Flows that end the command when one of them is true, so that no further cycle follows.
    pub(super) ends: Vec<PortRef>,
    /// Whether the command always ends in its first cycle.
    pub(super) ends_at_once: bool,
}

/// Conditions that end a command alone. A `yield` is not among them, since it needs a successor.
pub(super) fn ends(net: &Net) -> Vec<PortRef> {
    let Driver::Results(results) = &net.driver else {
        return Vec::new();
    };
    let sure = results
        .iter()
        .filter(|result| result.kind != ResultKind::Yield);
    sure.filter_map(|result| result.condition.port()).collect()
}

/// Whether a command always ends in its first cycle.
pub(super) fn ends_at_once(net: &Net) -> bool {
    let Driver::Results(results) = &net.driver else {
        return false;
    };
    results.iter().any(|result| {
        let is_sure = result.kind != ResultKind::Yield;
        is_sure && matches!(&result.condition, Input::Const(value) if value.as_bool() == Some(true))
    })
}
