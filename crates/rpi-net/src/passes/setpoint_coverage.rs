//! Set-point coverage (M9.3): whether an actuator has a set-point in every cycle, and if not, why.
//!
//! Without a set-point, a device at rest holds its position, and a moving device stops with a fault. So the author of a
//! program should know the cycles in which one may be missing.

use super::Schedule;
use super::fact_prover::{EffortBudget, Event, ProofContext, Prover};
use super::model_check;
use super::presence::FlowPresence;
use super::writers::{Resource, Writers, are_alternatives, resource, write_event};
use crate::net::{Activation, FragmentId, Input, Net, NodeId, PortRef, Termination};
use rpi_diag::{Code, Diagnostic};
use rpi_image::{Presence, Role};
use std::collections::BTreeSet;

/// Maximum number of actuators per command for which the model checker is used. Bounds the compile time.
const MAX_SOLVER_CALLS: usize = 8;
/// Maximum number of reasons that the diagnostic about one actuator shows, so that the message stays readable.
const MAX_REASONS: usize = 4;

/// Reason for which a set-point may be absent.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum Reason {
    /// The fragment that computes the set-point, or a flow that it depends on, is not always active.
    Inactive(FragmentId),
    /// A flow on which the set-point depends is absent in some cycles.
    Absent(PortRef),
}

/// Actuator that may have no set-point in some cycle, with the reasons.
#[derive(Debug)]
pub(crate) struct MissingSetpoint {
    resource: Resource,
    writer: NodeId,
    reasons: BTreeSet<Reason>,
}

/// Returns the actuators of a program that may have no set-point in some cycle. Imported nets are not checked, as there
/// is no program text to correct.
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

/// Returns whether the set-points of a net are checked. Tests and imported nets are not checked.
fn is_checked(net: &Net) -> bool {
    !net.is_test && matches!(net.termination, Termination::Results(_))
}

/// Returns whether two resources are the same port of a device. The index among several equal ports is ignored.
fn is_same_port(a: &Resource, b: &Resource) -> bool {
    a.device == b.device && a.port == b.port
}

/// Returns whether the presence analysis alone shows that an event occurs in every cycle.
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

/// Search for the reasons for which a flow may be absent.
struct Search<'a> {
    background: ProofContext<'a>,
    seen: BTreeSet<PortRef>,
    found: BTreeSet<Reason>,
}

impl Search<'_> {
    /// Adds the reasons for which a flow may be absent for a reader in the fragment `reader`. Follows the flows that
    /// decide the presence.
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

/// Returns the diagnostic for an actuator that may have no set-point.
pub(crate) fn diagnostic(net: &Net, gap: &MissingSetpoint) -> Diagnostic {
    let Resource { device, port, .. } = &gap.resource;
    let message = format!("`{device}.{port}` may have no set-point in some cycles");
    let diagnostic = Diagnostic::new(Code::RPI6104, message)
        .primary(net.node(gap.writer).origin.span, "no value in these cycles");
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
        .help(match driven_alternative(net, &gap.resource) {
            Some(other) => format!(
                "let one of `{device}.{port}` and `{}.{}` have a value in each cycle: under a condition and its `not`",
                other.device, other.port
            ),
            None => format!(
                "append `?? ...` to the equation of `{device}.{port}`, with a value that is always present"
            ),
        })
}

/// Returns another port of the same actuator that the net drives.
fn driven_alternative(net: &Net, port: &Resource) -> Option<Resource> {
    let mut driven = net.node_ids().filter_map(|id| resource(net.node(id)));
    driven.find(|other| are_alternatives(net, other, port))
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

/// Returns one line of text on the actuators that may have no set-point.
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
