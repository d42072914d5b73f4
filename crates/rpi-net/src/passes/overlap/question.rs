//! What is asked: what may happen in one cycle of one command.

use super::cone::Cone;
use super::cycle::Cycle;
use super::domain::Domain;
use crate::net::{Driver, Input, Net, PortRef, ResultKind};
use crate::passes::proof::Happening;

/// Something that a cycle may be.
#[derive(Clone, Debug)]
pub(super) enum Event {
    /// Both happen.
    Both([Happening; 2]),
    /// None of these happens.
    Neither(Vec<Happening>),
}

impl Event {
    /// What it speaks of.
    pub(super) fn happenings(&self) -> &[Happening] {
        match self {
            Event::Both(both) => both,
            Event::Neither(all) => all,
        }
    }

    /// Whether a cycle is so.
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

/// Events, and the part of the net that decides them.
pub(super) struct Question<'a> {
    pub(super) cone: Cone<'a>,
    pub(super) events: Vec<Event>,
    /// Flows of which one ends the command when it is true: no cycle comes after that.
    pub(super) ends: Vec<PortRef>,
    /// Whether the command ends in its first cycle whatever happens.
    pub(super) ends_at_once: bool,
}

/// The conditions that end a command by themselves; a `yield` needs a successor.
pub(super) fn ends(net: &Net) -> Vec<PortRef> {
    let Driver::Results(results) = &net.driver else {
        return Vec::new();
    };
    let sure = results
        .iter()
        .filter(|result| result.kind != ResultKind::Yield);
    sure.filter_map(|result| result.condition.port()).collect()
}

/// Whether a command ends in its first cycle whatever happens: then nothing comes after it.
pub(super) fn ends_at_once(net: &Net) -> bool {
    let Driver::Results(results) = &net.driver else {
        return false;
    };
    results.iter().any(|result| {
        let is_sure = result.kind != ResultKind::Yield;
        is_sure && matches!(&result.condition, Input::Const(value) if value.as_bool() == Some(true))
    })
}
