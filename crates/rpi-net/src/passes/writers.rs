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

/// Maximum number of pairs of writers that are examined. Further pairs count as not proved exclusive.
const MAX_PAIRS: usize = 20_000;

/// Maximum number of pairs of writers for which the model checker is used. Bounds the compile time.
const MAX_SOLVER_PAIRS: usize = 200;

/// Ports of an arm in the reference system that drive the same motion, so that at most one may be written in a cycle.
pub(crate) const SAME_MOTION: [&str; 2] = ["joint.position", "tcp.position"];

/// Actuator port of a device, as a resource that a command holds.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Resource {
    /// Name of the device in the command.
    pub device: String,
    /// Name of the actuator port, such as `tcp`.
    pub port: String,
    /// Index that selects one of several equal ports of the device; 0 if there is only one.
    pub index: i64,
}

impl fmt::Display for Resource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}[{}]", self.device, self.port, self.index)
    }
}

/// Pair of nodes that write the same resource, or ports that drive the same actuator.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct WriterPair {
    /// The two nodes that write the same resource.
    pub writers: [NodeId; 2],
    /// Whether the writers are proved never to write in the same cycle.
    pub exclusive: bool,
}

/// Nodes that write the actuators of a net, and the pairs of them that write the same actuator.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Writers {
    /// Nodes that write each actuator port, in declaration order.
    pub by_resource: BTreeMap<Resource, Vec<NodeId>>,
    /// Pairs of nodes that write the same actuator, each with whether they are proved exclusive.
    pub pairs: Vec<WriterPair>,
    /// Results of the model checker for the pairs that the prover of facts about single cycles did not decide.
    verdicts: BTreeMap<[NodeId; 2], Verdict>,
}

impl Writers {
    /// Collects the writers of a net and tries to prove pairs of them exclusive. The model checker is used for programs
    /// with a schedule only.
    pub(crate) fn new(background: ProofContext<'_>, schedule: Option<&Schedule>) -> Self {
        let mut of: BTreeMap<Resource, Vec<NodeId>> = BTreeMap::new();
        for id in background.net.node_ids() {
            if let Some(resource) = resource(background.net.node(id)) {
                of.entry(resource).or_default().push(id);
            }
        }
        let mut pairs = prove_pairs(background, &candidate_pairs(background.net, &of));
        // The device bank checks imported nets in each cycle. A proof would only save the importer of programs a selection
        // here and there, and takes most of the time of loading a net.
        let schedule = schedule.filter(|_| !is_imported(background.net));
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

    /// Returns the names of the methods by which the model checker proved pairs exclusive, each once.
    pub(crate) fn methods(&self) -> Vec<String> {
        let methods = self.verdicts.values().filter_map(|verdict| match verdict {
            Verdict::Exclusive(method) => Some(*method),
            _ => None,
        });
        let methods: BTreeSet<_> = methods.collect();
        methods.iter().map(ToString::to_string).collect()
    }

    /// Returns an example run in which both writers of a pair write in the same cycle; `None` if none is known.
    fn witness(&self, pair: [NodeId; 2]) -> Option<&Witness> {
        match self.verdicts.get(&pair) {
            Some(Verdict::Witnessed(witness)) => Some(witness),
            _ => None,
        }
    }

    /// Returns the pairs of writers that are not proved exclusive.
    pub fn unproved(&self) -> impl Iterator<Item = [NodeId; 2]> + '_ {
        self.pairs
            .iter()
            .filter(|p| !p.exclusive)
            .map(|p| p.writers)
    }
}

/// Returns whether a net was read from a file of the reference system. Its author cannot correct a program text.
fn is_imported(net: &Net) -> bool {
    matches!(net.termination, Termination::Ports { .. })
}

/// Returns the actuator port that a node writes; `None` if it writes none.
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

/// Returns all pairs of nodes that write the same actuator port, or ports that drive the same actuator.
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

/// Returns whether two different ports of a device drive the same actuator.
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

/// Returns the event that a writer writes in a cycle: its fragment is active and its inputs are present.
pub(crate) fn write_event(net: &Net, writer: NodeId) -> Event {
    let node = net.node(writer);
    Event {
        fragment: node.fragment,
        present: node.inputs.iter().filter_map(Input::port).collect(),
    }
}

/// Returns the results of the model checker for the pairs that are not proved exclusive yet.
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

/// Returns a diagnostic for each actuator of a program with two writers that write, or might write, in the same cycle.
/// Among several pairs of writers, one with an example run is preferred.
pub(crate) fn check(net: &Net, writers: &Writers) -> Vec<Diagnostic> {
    if is_imported(net) {
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

/// Returns two resources and their writers in the order of the writers in the program text.
fn in_text_order(
    net: &Net,
    [a, b]: [Resource; 2],
    [first, second]: [NodeId; 2],
) -> ([Resource; 2], [NodeId; 2]) {
    let start = |node: NodeId| {
        let span = net.node(node).origin.span;
        (span.file, span.start)
    };
    match start(second) < start(first) {
        true => ([b, a], [second, first]),
        false => ([a, b], [first, second]),
    }
}

/// Returns the diagnostic for two set-points of the same actuator, with labels at both locations.
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
        .help(match a == b {
            true => "merge the alternatives with `??`, or make their conditions mutually exclusive",
            false => "let their conditions exclude each other: a condition for one, and its `not` for the other",
        })
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
