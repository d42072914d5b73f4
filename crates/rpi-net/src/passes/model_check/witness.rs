//! Witness: an example run in which two events occur, described by the flow values that cause them.

use super::concrete::BoundaryValues;
use super::concrete::TICK_NS;
use super::gates::Gate;
use super::query::Problem;
use super::trace::{Trace, values};
use crate::net::{Activation, FragmentId, Input, Node, PortRef, strip_unnamed_calls};
use crate::passes::fact_prover::Event;
use rpi_image::{CommandFlow, Role, Scalar, Type, Value};
use rustc_hash::FxHashSet;
use std::fmt;

/// Maximum number of flows and states that the description of an example run shows, so that the message stays readable.
const MAX_SHOWN: usize = 4;
/// Maximum number of flows visited in the search for flows with names in the program. Bounds the compile time.
const MAX_SEARCHED: usize = 400;

/// Description of the last cycle of an example run, for the diagnostic about two events in that cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Witness {
    /// Number of cycles before the cycle in which both events occur.
    pub(crate) cycle: usize,
    /// Phrases about the flows and states that cause the events, such as `` `x` = 3 ``.
    parts: Vec<String>,
}

impl fmt::Display for Witness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("both are present")?;
        for (k, part) in self.parts.iter().enumerate() {
            let joint = if k == 0 { "when" } else { "and" };
            write!(f, " {joint} {part}")?;
        }
        match (self.cycle, self.parts.is_empty()) {
            (0, true) => f.write_str(" in the first cycle"),
            (0, false) => Ok(()),
            (n, true) => write!(f, " after {}", rpi_diag::with_noun(n, "cycle")),
            (n, false) => write!(f, ", for example after {}", rpi_diag::with_noun(n, "cycle")),
        }
    }
}

/// Describes the causes of the events of the query with the index `pair` in the last cycle of the run `trace`.
pub(super) fn describe(
    question: &Problem<'_>,
    pool: &BoundaryValues,
    pair: usize,
    trace: &Trace,
) -> Witness {
    let mut search = Search {
        question,
        seen: FxHashSet::default(),
        open: Vec::new(),
        named: Vec::new(),
        active: Vec::new(),
    };
    for event in question.events[pair].events() {
        search.event(event);
    }
    search.run();
    let (named, active) = (search.named, search.active);
    let values = values(question, pool, trace, &named);
    let net = question.cone.net;
    let flows = named.iter().filter_map(|port| {
        let name = name(net.node(port.node))?;
        let value = text(net.node(port.node), &values.get(port)?.value)?;
        Some(format!("`{name}` {value}"))
    });
    let active = active
        .iter()
        .map(|id| format!("`{}` is active", net.fragment(*id).name));
    let mut parts: Vec<String> = Vec::new();
    for part in flows.chain(active) {
        if parts.len() < MAX_SHOWN && !parts.contains(&part) {
            parts.push(part);
        }
    }
    Witness {
        cycle: trace.last,
        parts,
    }
}

/// Backward search from events to the nearest flows with names in the program.
struct Search<'a> {
    question: &'a Problem<'a>,
    seen: FxHashSet<PortRef>,
    open: Vec<PortRef>,
    named: Vec<PortRef>,
    /// Fragments that must be active and whose condition has no name of its own: states of automata.
    active: Vec<FragmentId>,
}

impl Search<'_> {
    fn event(&mut self, event: &Event) {
        self.fragment(event.fragment);
        for port in &event.present {
            self.presence(*port);
        }
    }

    /// Adds the flows that decide whether the flow `port` is present, whatever its value.
    fn presence(&mut self, port: PortRef) {
        let node = self.question.cone.net.node(port.node);
        let inputs = match Gate::from_node(node) {
            Some(Gate::IfThenElse) => 0..3,
            Some(Gate::SetNull) => 1..2,
            _ => 0..0,
        };
        self.fragment(node.fragment);
        for (k, input) in node
            .inputs
            .iter()
            .enumerate()
            .filter(|(k, _)| inputs.contains(k))
        {
            if let Some(port) = input.port() {
                match k {
                    0 => self.push(port),
                    _ if inputs.len() == 1 => self.push(port),
                    _ => self.presence(port),
                }
            }
        }
    }

    fn fragment(&mut self, id: FragmentId) {
        let net = self.question.cone.net;
        for id in net.ancestors(id) {
            let fragment = net.fragment(id);
            if let Activation::When { condition, .. } = fragment.activation {
                // The condition of a state is derived from the automaton around it.
                let is_state = net
                    .node(condition.node)
                    .origin
                    .span
                    .contains(fragment.origin.span);
                match is_state && !fragment.name.is_empty() {
                    true if !self.active.contains(&id) => self.active.push(id),
                    true => {}
                    false => self.push(condition),
                }
            }
        }
    }

    fn push(&mut self, port: PortRef) {
        if self.seen.len() < MAX_SEARCHED && self.seen.insert(port) {
            self.open.push(port);
        }
    }

    fn run(&mut self) {
        let mut at = 0;
        while let Some(&port) = self.open.get(at) {
            at += 1;
            let net = self.question.cone.net;
            let node = net.node(port.node);
            if name(node).is_some() && is_shown(node, port) {
                self.named.push(port);
            } else if node.desc().role == Role::IsAbsent {
                let inputs: Vec<PortRef> = node.inputs.iter().filter_map(Input::port).collect();
                inputs.into_iter().for_each(|port| self.presence(port));
            } else if node.desc().role != Role::Delay {
                let inputs: Vec<PortRef> = node.inputs.iter().filter_map(Input::port).collect();
                inputs.into_iter().for_each(|port| self.push(port));
            }
        }
    }
}

/// Returns the name of the node's flow in the program; `None` if it has no name there.
fn name(node: &Node) -> Option<String> {
    let core = match node.desc().role {
        Role::Flow(CommandFlow::Time | CommandFlow::Elapsed) => Some("time"),
        Role::Flow(CommandFlow::Cancel) => Some("cancel"),
        Role::Flow(CommandFlow::Takeover) => Some("takeover"),
        _ => None,
    };
    if let Some(core) = core {
        return Some(core.to_owned());
    }
    let flow = node.origin.flow.as_ref()?;
    let name = strip_unnamed_calls(flow);
    (!name.contains('#')).then_some(name)
}

fn is_shown(node: &Node, port: PortRef) -> bool {
    let ty = node.outputs.get(usize::from(port.port));
    let is_constant = node.desc().role == Role::Constant;
    !is_constant
        && matches!(
            ty,
            Some(Type::Scalar(Scalar::Bool | Scalar::Int | Scalar::Real))
        )
}

/// Returns a phrase with a value, such as `is true` or `= 3`, to be appended to the name of its flow; `None` for types
/// without a short form.
fn text(node: &Node, value: &Value) -> Option<String> {
    if node.desc().role == Role::Flow(CommandFlow::Elapsed) {
        let seconds = rpi_prims::seconds(value.as_int()?, TICK_NS);
        return Some(format!("= {seconds:?}[s]"));
    }
    if let Some(truth) = value.as_bool() {
        return Some(format!("is {truth}"));
    }
    if let Some(int) = value.as_int() {
        return Some(format!("= {int}"));
    }
    value.as_real().map(|real| format!("= {real:?}"))
}
