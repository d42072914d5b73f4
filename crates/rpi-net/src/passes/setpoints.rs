//! Set-point coverage (M9.3): whether an actuator has a set-point in every cycle, and if not, why.
//!
//! Without a set-point, a device at rest holds its position, and a moving device stops with a fault. So the author of a
//! program should know the cycles in which one may be missing.

use super::Schedule;
use super::overlap;
use super::presence::Sureness;
use super::proof::{Background, Effort, Happening, Prover};
use super::writers::{Resource, Writers, alternative, happening};
use crate::net::{Activation, Driver, FragmentId, Input, Net, NodeId, PortRef};
use rpi_diag::{Code, Finding};
use rpi_image::{Presence, Role};
use std::collections::BTreeSet;

/// Maximal number of actuators of a command for which the solver is used.
const HARD: usize = 8;
/// Maximal number of reasons shown for one actuator.
const REASONS: usize = 4;

/// Reason for which a set-point may be absent.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum Reason {
    /// The fragment that computes it is not always active.
    Inactive(FragmentId),
    /// A flow that it depends on is absent in some cycles.
    Absent(PortRef),
}

/// Actuator that may have no set-point, with the reasons.
#[derive(Debug)]
pub(crate) struct Gap {
    resource: Resource,
    writer: NodeId,
    reasons: BTreeSet<Reason>,
}

/// Returns the actuators of a program that may have no set-point in some cycle, each once. Imported nets are not
/// checked: there is no source to correct.
pub(crate) fn gaps(
    background: Background<'_>,
    schedule: Option<&Schedule>,
    writers: &Writers,
) -> Vec<Gap> {
    let net = background.net;
    if !is_looked_at(net) {
        return Vec::new();
    }
    let effort = Effort::default();
    let mut prover = None;
    let mut hard = 0;
    let mut told: Vec<&Resource> = Vec::new();
    let mut gaps = Vec::new();
    for (resource, own) in &writers.of {
        let is_told = |r: &&Resource| is_same(r, resource) || alternative(net, r, resource);
        if told.iter().any(is_told) {
            continue;
        }
        let others = writers
            .of
            .iter()
            .filter(|(r, _)| alternative(net, r, resource));
        let all = own.iter().chain(others.flat_map(|(_, writers)| writers));
        let all: Vec<Happening> = all.map(|writer| happening(net, *writer)).collect();
        if all.iter().any(|one| is_sure(background, one)) {
            continue;
        }
        let prover = prover.get_or_insert_with(|| Prover::new(background, &effort));
        let is_hard = all.len() > 1 && hard < HARD;
        let is_covered = prover.always_one(&all)
            || schedule.is_some_and(|s| is_hard && overlap::always_one(background, s, &all));
        hard += usize::from(is_hard);
        if !is_covered {
            told.push(resource);
            gaps.extend(own.first().map(|writer| Gap {
                resource: resource.clone(),
                writer: *writer,
                reasons: reasons(background, &all),
            }));
        }
    }
    gaps
}

/// Whether the net is checked. Tests drive no actuators.
fn is_looked_at(net: &Net) -> bool {
    !net.is_test && matches!(net.driver, Driver::Results(_))
}

/// Whether two resources are the same port of a device, regardless of the index.
fn is_same(a: &Resource, b: &Resource) -> bool {
    a.device == b.device && a.port == b.port
}

/// Whether an event occurs in every cycle according to the presence analysis alone.
fn is_sure(background: Background<'_>, happening: &Happening) -> bool {
    let (gates, open) = background.doubts(happening);
    gates.is_empty() && open.is_empty()
}

fn seen(background: Background<'_>, reader: FragmentId, input: &Input) -> Sureness {
    let Background {
        net,
        tree,
        presences,
        ..
    } = background;
    presences.seen(net, tree, reader, input)
}

fn reasons(background: Background<'_>, writers: &[Happening]) -> BTreeSet<Reason> {
    let mut search = Search {
        background,
        seen: BTreeSet::new(),
        found: BTreeSet::new(),
    };
    for writer in writers {
        let (gates, open) = background.doubts(writer);
        search.found.extend(gates.into_iter().map(Reason::Inactive));
        for port in open {
            search.follow(writer.fragment, port);
        }
    }
    search.found
}

/// Search for the reasons for which a flow is absent.
struct Search<'a> {
    background: Background<'a>,
    seen: BTreeSet<PortRef>,
    found: BTreeSet<Reason>,
}

impl Search<'_> {
    /// Adds the reasons for which a flow is absent for its reader, following the flows that decide its presence.
    fn follow(&mut self, reader: FragmentId, port: PortRef) {
        let Background {
            net,
            tree,
            presences,
            ..
        } = self.background;
        let mut open = vec![(reader, port)];
        while let Some((reader, port)) = open.pop() {
            let view = presences.view(net, tree, reader, port);
            let gates = view.through.into_iter();
            self.found.extend(gates.map(Reason::Inactive));
            if view.own == Sureness::Total || !self.seen.insert(port) {
                continue;
            }
            let node = net.node(port.node);
            let rule = node.desc().outputs[usize::from(port.port)].presence;
            if node.desc().role == Role::Delay || matches!(rule, Presence::Maybe | Presence::Always)
            {
                self.found.insert(Reason::Absent(port));
                continue;
            }
            let inputs = node
                .inputs
                .iter()
                .filter(|input| seen(self.background, node.fragment, input) != Sureness::Total);
            open.extend(
                inputs
                    .filter_map(Input::port)
                    .map(|input| (node.fragment, input)),
            );
        }
    }
}

/// Returns the diagnostic for a missing set-point.
pub(crate) fn finding(net: &Net, gap: &Gap) -> Finding {
    let Resource { device, port, .. } = &gap.resource;
    let message = format!("`{device}.{port}` may have no set-point in some cycles");
    let finding = Finding::new(Code::RPI6104, message).at(
        net.node(gap.writer).origin.span,
        "absent in cycles without a value",
    );
    let shown = gap.reasons.iter().take(REASONS);
    let finding = shown.fold(finding, |finding, reason| labelled(net, finding, *reason));
    let finding = match gap.reasons.len().saturating_sub(REASONS) {
        0 => finding,
        1 => finding.note("and one more flow that is not always present"),
        more => finding.note(format!("and {more} more flows that are not always present")),
    };
    finding
        .note("without a set-point a resting device holds its position; a moving one stops with a fault")
        .help("add a last alternative that is always present: `... ?? x`")
}

fn labelled(net: &Net, finding: Finding, reason: Reason) -> Finding {
    let fragment = match reason {
        Reason::Absent(port) => {
            return finding.also(net.node(port.node).origin.span, "absent in some cycles");
        }
        Reason::Inactive(fragment) => net.fragment(fragment),
    };
    let name = match fragment.name.as_str() {
        "" => "this part".to_owned(),
        name => format!("`{name}`"),
    };
    let own = fragment.origin.span;
    match &fragment.activation {
        Activation::When { condition, .. } => {
            let place = net.node(condition.node).origin.span;
            // The condition of a state is derived from the automaton around it, so the state itself is labelled.
            match place.contains(own) {
                true => finding.also(own, format!("{name} is not always active")),
                false => finding.also(place, format!("{name} is only active while this holds")),
            }
        }
        Activation::Always => finding.also(own, format!("{name} is not always active")),
    }
}

/// Summary of the set-point coverage.
pub(crate) fn told(net: &Net, writers: &Writers, gaps: &[Gap]) -> String {
    let name = |gap: &Gap| format!("{}.{}", gap.resource.device, gap.resource.port);
    let names: Vec<String> = gaps.iter().map(name).collect();
    match (is_looked_at(net), writers.of.is_empty(), names.is_empty()) {
        (false, ..) => "only checked in programs".to_owned(),
        (true, true, _) => "no actuator is driven".to_owned(),
        (true, false, true) => "every actuator has a set-point in every cycle".to_owned(),
        (true, false, false) => format!("may be absent: {}", names.join(", ")),
    }
}
