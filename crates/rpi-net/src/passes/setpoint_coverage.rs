//! Set-point coverage (M9.3): whether an actuator has a set-point in every cycle, and if not, why.
//!
//! Without a set-point, a device at rest holds its position, and a moving device stops with a fault. So the author of a
//! program should know the cycles in which one may be missing.

use super::Schedule;
use super::fact_prover::{EffortBudget, Event, ProofContext, Prover};
use super::model_check;
use super::presence::FlowPresence;
use super::writers::{Resource, Writers, are_alternatives, write_event};
use crate::net::{Activation, FragmentId, Input, Net, NodeId, PortRef, Termination};
use rpi_diag::{Code, Diagnostic};
use rpi_image::{Presence, Role};
use std::collections::BTreeSet;

/// Maximal number of actuators of a command for which the model checker is used.
const MAX_SOLVER_CALLS: usize = 8;
/// Maximal number of reasons shown for one actuator.
const MAX_REASONS: usize = 4;

/// Reason for which a set-point may be absent.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum Reason {
    /// The fragment that computes the set-point is not always active.
    Inactive(FragmentId),
    /// A flow that it depends on is absent in some cycles.
    Absent(PortRef),
}

/// Actuator that may have no set-point, with the reasons.
#[derive(Debug)]
pub(crate) struct MissingSetpoint {
    resource: Resource,
    writer: NodeId,
    reasons: BTreeSet<Reason>,
}

/// Returns the actuators of a program that may have no set-point in some cycle. Imported nets are not checked: there is
/// no source to correct.
pub(crate) fn missing_setpoints(
    background: ProofContext<'_>,
    schedule: Option<&Schedule>,
    writers: &Writers,
) -> Vec<MissingSetpoint> {
    let net = background.net;
    if !is_checked(net) {
        return Vec::new();
    }
    let effort = EffortBudget::default();
    let mut prover = None;
    let mut hard = 0;
    let mut reported: Vec<&Resource> = Vec::new();
    let mut gaps = Vec::new();
    for (resource, own) in &writers.by_resource {
        let is_reported =
            |r: &&Resource| is_same_port(r, resource) || are_alternatives(net, r, resource);
        if reported.iter().any(is_reported) {
            continue;
        }
        let others = writers
            .by_resource
            .iter()
            .filter(|(r, _)| are_alternatives(net, r, resource));
        let all = own.iter().chain(others.flat_map(|(_, writers)| writers));
        let all: Vec<Event> = all.map(|writer| write_event(net, *writer)).collect();
        if all.iter().any(|one| is_always(background, one)) {
            continue;
        }
        let prover = prover.get_or_insert_with(|| Prover::new(background, &effort));
        let is_hard = all.len() > 1 && hard < MAX_SOLVER_CALLS;
        let is_covered = prover.always_one(&all)
            || schedule.is_some_and(|s| is_hard && model_check::always_one(background, s, &all));
        hard += usize::from(is_hard);
        if !is_covered {
            reported.push(resource);
            gaps.extend(own.first().map(|writer| MissingSetpoint {
                resource: resource.clone(),
                writer: *writer,
                reasons: reasons(background, &all),
            }));
        }
    }
    gaps
}

/// Whether the set-points of a net are checked. Tests drive no actuators.
fn is_checked(net: &Net) -> bool {
    !net.is_test && matches!(net.termination, Termination::Results(_))
}

/// Whether two resources are the same port of a device, regardless of the index.
fn is_same_port(a: &Resource, b: &Resource) -> bool {
    a.device == b.device && a.port == b.port
}

/// Whether an event occurs in every cycle, as far as the presence analysis alone shows.
fn is_always(background: ProofContext<'_>, event: &Event) -> bool {
    let (gates, open) = background.obstacles(event);
    gates.is_empty() && open.is_empty()
}

fn seen(background: ProofContext<'_>, reader: FragmentId, input: &Input) -> FlowPresence {
    let ProofContext {
        net,
        tree,
        presences,
        ..
    } = background;
    presences.presence_at(net, tree, reader, input)
}

fn reasons(background: ProofContext<'_>, writers: &[Event]) -> BTreeSet<Reason> {
    let mut search = Search {
        background,
        seen: BTreeSet::new(),
        found: BTreeSet::new(),
    };
    for writer in writers {
        let (gates, open) = background.obstacles(writer);
        search.found.extend(gates.into_iter().map(Reason::Inactive));
        for port in open {
            search.follow(writer.fragment, port);
        }
    }
    search.found
}

/// Search for the reasons for which a flow is absent.
struct Search<'a> {
    background: ProofContext<'a>,
    seen: BTreeSet<PortRef>,
    found: BTreeSet<Reason>,
}

impl Search<'_> {
    /// Adds the reasons for which a flow is absent for its reader, following the flows that decide its presence.
    fn follow(&mut self, reader: FragmentId, port: PortRef) {
        let ProofContext {
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
            if view.own == FlowPresence::Total || !self.seen.insert(port) {
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
                .filter(|input| seen(self.background, node.fragment, input) != FlowPresence::Total);
            open.extend(
                inputs
                    .filter_map(Input::port)
                    .map(|input| (node.fragment, input)),
            );
        }
    }
}

/// Returns the diagnostic for a missing set-point.
pub(crate) fn diagnostic(net: &Net, gap: &MissingSetpoint) -> Diagnostic {
    let Resource { device, port, .. } = &gap.resource;
    let message = format!("`{device}.{port}` may have no set-point in some cycles");
    let diagnostic = Diagnostic::new(Code::RPI6104, message).primary(
        net.node(gap.writer).origin.span,
        "absent in cycles without a value",
    );
    let shown = gap.reasons.iter().take(MAX_REASONS);
    let diagnostic = shown.fold(diagnostic, |diagnostic, reason| {
        labelled(net, diagnostic, *reason)
    });
    let diagnostic = match gap.reasons.len().saturating_sub(MAX_REASONS) {
        0 => diagnostic,
        1 => diagnostic.note("and one more flow that is not always present"),
        more => diagnostic.note(format!("and {more} more flows that are not always present")),
    };
    diagnostic
        .note("without a set-point a resting device holds its position; a moving one stops with a fault")
        .help("add a last alternative that is always present: `... ?? x`")
}

fn labelled(net: &Net, diagnostic: Diagnostic, reason: Reason) -> Diagnostic {
    let fragment = match reason {
        Reason::Absent(port) => {
            return diagnostic.secondary(net.node(port.node).origin.span, "absent in some cycles");
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
                true => diagnostic.secondary(own, format!("{name} is not always active")),
                false => {
                    diagnostic.secondary(place, format!("{name} is only active while this holds"))
                }
            }
        }
        Activation::Always => diagnostic.secondary(own, format!("{name} is not always active")),
    }
}

/// Summary of the set-point coverage.
pub(crate) fn summary(net: &Net, writers: &Writers, gaps: &[MissingSetpoint]) -> String {
    let name = |gap: &MissingSetpoint| format!("{}.{}", gap.resource.device, gap.resource.port);
    let names: Vec<String> = gaps.iter().map(name).collect();
    match (
        is_checked(net),
        writers.by_resource.is_empty(),
        names.is_empty(),
    ) {
        (false, ..) => "only checked in programs".to_owned(),
        (true, true, _) => "no actuator is driven".to_owned(),
        (true, false, true) => "every actuator has a set-point in every cycle".to_owned(),
        (true, false, false) => format!("may be absent: {}", names.join(", ")),
    }
}
