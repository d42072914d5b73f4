//! Writers of actuators, and whether two of them ever write in the same cycle (M9).
//!
//! A resource is one port of a device with its index. Ports that a device declares as alternatives of one actuator also
//! exclude each other. Writers of one resource must be mutually exclusive: this is proved, or checked in each cycle by
//! the device bank (imported nets), or else the program is rejected.

use super::Schedule;
use super::fact_prover::{EffortBudget, Event, ProofContext, Prover};
use super::model_check::{self, Verdict, Witness};
use crate::net::{Input, Net, Node, NodeId, Termination};
use rpi_diag::{Code, Diagnostic};
use rpi_image::{DevicePortNames, Role, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Maximal number of pairs of writers that are examined. Further pairs count as not proved.
const MAX_PAIRS: usize = 20_000;

/// Maximal number of pairs for which the model checker is used.
const MAX_SOLVER_PAIRS: usize = 200;

/// Ports of the reference system's arms that drive the same motion.
pub(crate) const SAME_MOTION: [&str; 2] = ["joint.position", "tcp.position"];

/// Port of a device, as a resource that a command takes.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Resource {
    /// Name of the device that a command of the net uses.
    pub device: String,
    /// Name of the port.
    pub port: String,
    /// Index among several equal ports.
    pub index: i64,
}

impl fmt::Display for Resource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}[{}]", self.device, self.port, self.index)
    }
}

/// Pair of writers of the same resource, or of alternative ones.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct WriterPair {
    /// Nodes that write the two ports.
    pub writers: [NodeId; 2],
    /// Whether the writers are proved never to write in the same cycle.
    pub exclusive: bool,
}

/// Writers of the actuators of a net, and the pairs of them that might write in the same cycle.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Writers {
    /// Writers of each resource, in declaration order.
    pub by_resource: BTreeMap<Resource, Vec<NodeId>>,
    /// All pairs of writers that might write in the same cycle.
    pub pairs: Vec<WriterPair>,
    /// Verdicts of the model checker for the pairs that the fact-based prover did not decide.
    verdicts: BTreeMap<[NodeId; 2], Verdict>,
}

impl Writers {
    /// Collects the writers of a net and proves pairs exclusive. Without a schedule, only the fact-based prover is
    /// used.
    pub(crate) fn new(background: ProofContext<'_>, schedule: Option<&Schedule>) -> Self {
        let mut of: BTreeMap<Resource, Vec<NodeId>> = BTreeMap::new();
        for id in background.net.node_ids() {
            if let Some(resource) = resource(background.net.node(id)) {
                of.entry(resource).or_default().push(id);
            }
        }
        let mut pairs = prove_pairs(background, &candidate_pairs(background.net, &of));
        let verdicts = schedule.map_or_else(BTreeMap::new, |schedule| {
            solve_pairs(background, schedule, &pairs)
        });
        for pair in &mut pairs {
            let verdict = verdicts.get(&pair.writers);
            pair.exclusive |= matches!(verdict, Some(Verdict::Exclusive(_)));
        }
        Writers {
            by_resource: of,
            pairs,
            verdicts,
        }
    }

    /// Names of the methods of the model checker that proved pairs exclusive, each once.
    pub(crate) fn methods(&self) -> Vec<String> {
        let methods = self.verdicts.values().filter_map(|verdict| match verdict {
            Verdict::Exclusive(method) => Some(*method),
            _ => None,
        });
        let methods: BTreeSet<_> = methods.collect();
        methods.iter().map(ToString::to_string).collect()
    }

    /// Example run in which both writers of a pair write in the same cycle.
    fn witness(&self, pair: [NodeId; 2]) -> Option<&Witness> {
        match self.verdicts.get(&pair) {
            Some(Verdict::Witnessed(witness)) => Some(witness),
            _ => None,
        }
    }

    /// Pairs that are not proved exclusive.
    pub fn unproved(&self) -> impl Iterator<Item = [NodeId; 2]> + '_ {
        self.pairs
            .iter()
            .filter(|p| !p.exclusive)
            .map(|p| p.writers)
    }
}

/// Resource that a node writes; `None` if it does not write one.
#[must_use]
pub fn resource(node: &Node) -> Option<Resource> {
    let Role::Actuator(device) = node.desc().role else {
        return None;
    };
    let param = |name: &str| node.params.get(node.desc().param(name)?);
    let text = |name: &str| param(name).and_then(Value::as_str).unwrap_or("").to_owned();
    Some(Resource {
        device: text(device.device),
        port: match device.ports {
            DevicePortNames::Fixed(names) => names.first().copied().unwrap_or("").to_owned(),
            DevicePortNames::Param(name) => text(name),
        },
        index: device
            .index
            .and_then(|name| param(name)?.as_int())
            .unwrap_or(0),
    })
}

/// All pairs of writers of the same resource or of alternative ones.
fn candidate_pairs(net: &Net, of: &BTreeMap<Resource, Vec<NodeId>>) -> Vec<[NodeId; 2]> {
    let mut pairs = Vec::new();
    let all: Vec<(&Resource, &Vec<NodeId>)> = of.iter().collect();
    for (k, (resource, writers)) in all.iter().enumerate() {
        for (i, a) in writers.iter().enumerate() {
            pairs.extend(writers[i + 1..].iter().map(|b| [*a, *b]));
        }
        let others = all[k + 1..]
            .iter()
            .filter(|(other, _)| are_alternatives(net, resource, other));
        for (_, others) in others {
            pairs.extend(writers.iter().flat_map(|a| others.iter().map(|b| [*a, *b])));
        }
    }
    pairs
}

/// Whether two ports are alternatives that drive the same actuator.
pub(crate) fn are_alternatives(net: &Net, a: &Resource, b: &Resource) -> bool {
    let same_motion = |r: &Resource| SAME_MOTION.contains(&r.port.as_str());
    let declared = net.alternatives.iter().any(|group| {
        let holds = |r: &Resource| group.device == r.device && group.ports.contains(&r.port);
        holds(a) && holds(b)
    });
    a.device == b.device && a.port != b.port && (declared || (same_motion(a) && same_motion(b)))
}

fn prove_pairs(background: ProofContext<'_>, pairs: &[[NodeId; 2]]) -> Vec<WriterPair> {
    if pairs.is_empty() {
        return Vec::new();
    }
    let effort = EffortBudget::default();
    let mut prover = Prover::new(background, &effort);
    let judged = &pairs[..pairs.len().min(MAX_PAIRS)];
    let events: Vec<[Event; 2]> = judged
        .iter()
        .map(|pair| pair.map(|w| write_event(background.net, w)))
        .collect();
    let exclusive = prover.never_together(&events);
    let exclusive = exclusive.into_iter().chain(std::iter::repeat(false));
    let pair = |(writers, exclusive): (&[NodeId; 2], bool)| WriterPair {
        writers: *writers,
        exclusive,
    };
    pairs.iter().zip(exclusive).map(pair).collect()
}

/// The event that a writer writes: its fragment is active and its inputs are present.
pub(crate) fn write_event(net: &Net, writer: NodeId) -> Event {
    let node = net.node(writer);
    Event {
        fragment: node.fragment,
        present: node.inputs.iter().filter_map(Input::port).collect(),
    }
}

/// Verdicts of the model checker for the pairs that are not proved exclusive yet.
fn solve_pairs(
    background: ProofContext<'_>,
    schedule: &Schedule,
    pairs: &[WriterPair],
) -> BTreeMap<[NodeId; 2], Verdict> {
    let open = pairs
        .iter()
        .filter(|pair| !pair.exclusive)
        .take(MAX_SOLVER_PAIRS);
    let open: Vec<[NodeId; 2]> = open.map(|pair| pair.writers).collect();
    let events: Vec<[Event; 2]> = open
        .iter()
        .map(|pair| pair.map(|writer| write_event(background.net, writer)))
        .collect();
    let verdicts = model_check::decide(background, schedule, &events);
    open.into_iter().zip(verdicts).collect()
}

/// Checks that a program has one writer per actuator. Returns a diagnostic per resource with two writers that write, or
/// might write, in the same cycle. A pair with a known example run is preferred.
pub(crate) fn check(net: &Net, writers: &Writers) -> Vec<Diagnostic> {
    if matches!(net.termination, Termination::Ports { .. }) {
        return Vec::new();
    }
    let mut reported: BTreeMap<[Resource; 2], [NodeId; 2]> = BTreeMap::new();
    for pair in writers.unproved() {
        if let [Some(a), Some(b)] = pair.map(|w| resource(net.node(w))) {
            // All indices of a port share a diagnostic.
            let whole = |r: Resource| Resource { index: 0, ..r };
            let known = reported.entry([whole(a), whole(b)]).or_insert(pair);
            if writers.witness(*known).is_none() && writers.witness(pair).is_some() {
                *known = pair;
            }
        }
    }
    let diagnostics = reported.into_iter().map(|(resources, pair)| {
        let (resources, ordered) = in_text_order(net, resources, pair);
        match writers.witness(pair) {
            Some(witness) => overlap_diagnostic(net, &resources, ordered, witness),
            None => unproved_diagnostic(net, &resources, ordered),
        }
    });
    diagnostics.collect()
}

/// Sorts two resources and their writers by their location in the text.
fn in_text_order(
    net: &Net,
    [a, b]: [Resource; 2],
    [first, second]: [NodeId; 2],
) -> ([Resource; 2], [NodeId; 2]) {
    let start = |node: NodeId| net.node(node).origin.span.start;
    match start(second) < start(first) {
        true => ([b, a], [second, first]),
        false => ([a, b], [first, second]),
    }
}

/// Creates the diagnostic for two set-points of the same actuator, with labels at both locations.
fn diagnostic(
    net: &Net,
    (code, message): (Code, String),
    [first, second]: [NodeId; 2],
) -> Diagnostic {
    Diagnostic::new(code, message)
        .primary(net.node(second).origin.span, "a second set-point")
        .secondary(net.node(first).origin.span, "the first set-point")
}

fn name(resource: &Resource) -> String {
    format!("`{}.{}`", resource.device, resource.port)
}

fn overlap_diagnostic(
    net: &Net,
    [a, b]: &[Resource; 2],
    pair: [NodeId; 2],
    witness: &Witness,
) -> Diagnostic {
    let message = match a == b {
        true => format!("{} gets two set-points in the same cycle", name(a)),
        false => format!(
            "{} and {} may both get a set-point in the same cycle",
            name(a),
            name(b)
        ),
    };
    diagnostic(net, (Code::RPI6101, message), pair)
        .note(witness.to_string())
        .help("merge the alternatives with `??`, or make their conditions mutually exclusive")
}

fn unproved_diagnostic(net: &Net, [a, b]: &[Resource; 2], pair: [NodeId; 2]) -> Diagnostic {
    let message = format!(
        "{} and {} cannot be proved mutually exclusive",
        name(a),
        name(b)
    );
    diagnostic(net, (Code::RPI6105, message), pair)
        .note("this is checked in each cycle: two set-points at once are a fault, which ends the command")
        .help("make both depend on one condition: `when c` and `when not c`, or states of one automaton")
}
