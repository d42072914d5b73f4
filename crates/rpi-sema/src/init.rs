//! Initialisation (M5): a `pre` of a total flow has no value in the first cycle of its fragment, and nobody may read it
//! there.
//!
//! For each flow of a net the analysis finds for how many first cycles of its fragment it has no value: a delay adds one,
//! a choice by `first` takes one away, everything else passes on the worst of its inputs (Colaço and Pouzet,
//! Type-based initialization analysis of a synchronous dataflow language, 2004, with counted levels). What leaves the net,
//! or its fragment, must have a value in every cycle. The root, the delay itself, is named.

use rpi_diag::{Code, Finding, Fix};
use rpi_image::{Presence, Role};
use rpi_net::{Activation, Driver, Input, Net, Node, NodeId, PortRef};

/// A level that stands for "at any time": a flow without value in the first cycle of a fragment, read outside of it.
const ANY_TIME: u8 = u8::MAX;

/// For each node the first cycles in which it has no value, and the delay to blame.
struct Levels {
    level: Vec<u8>,
    root: Vec<Option<NodeId>>,
}

/// What is read before it has a value.
#[must_use]
pub fn check(net: &Net) -> Vec<Finding> {
    let levels = solve(net);
    let mut findings = Vec::new();
    for root in read_early(net, &levels) {
        findings.push(finding(net, root));
    }
    findings
}

fn solve(net: &Net) -> Levels {
    let mut levels = Levels {
        level: vec![0; net.nodes.len()],
        root: vec![None; net.nodes.len()],
    };
    let mut readers: Vec<Vec<NodeId>> = vec![Vec::new(); net.nodes.len()];
    let mut open = Vec::new();
    for id in net.node_ids() {
        for input in &net.node(id).inputs {
            if let Some(port) = input.port() {
                readers[port.node.index()].push(id);
            }
        }
        if is_total_delay(net.node(id)) {
            open.push(id);
        }
    }
    while let Some(id) = open.pop() {
        let (level, root) = levels.of_node(net, id);
        let at = id.index();
        if level > levels.level[at] {
            (levels.level[at], levels.root[at]) = (level, root);
            open.extend(&readers[at]);
        }
    }
    levels
}

impl Levels {
    /// The level of a node as its inputs have it.
    fn of_node(&self, net: &Net, id: NodeId) -> (u8, Option<NodeId>) {
        let node = net.node(id);
        if let Some([otherwise, then]) = arrow(net, node) {
            let (first, root) = self.seen(net, node, otherwise);
            let (later, later_root) = self.seen(net, node, then);
            return match (first, later) {
                (0, 0 | 1) => (0, None),
                (0, _) => (later, later_root),
                _ => (first, root),
            };
        }
        let inputs = node.inputs.iter().map(|input| self.seen(net, node, input));
        let worst = inputs.max_by_key(|(level, _)| *level).unwrap_or((0, None));
        match is_total_delay(node) {
            // Counting stops early: a delay in a ring would count for ever.
            true if worst.0 < 3 => (worst.0 + 1, Some(worst.1.unwrap_or(id))),
            true => (worst.0, worst.1),
            false => worst,
        }
    }

    /// A flow as a node sees it.
    fn seen(&self, net: &Net, reader: &Node, input: &Input) -> (u8, Option<NodeId>) {
        let Some(port) = input.port() else {
            return (0, None);
        };
        let (level, root) = (self.level[port.node.index()], self.root[port.node.index()]);
        let own = net.node(port.node).fragment;
        let inside = net
            .enclosing(reader.fragment)
            .any(|fragment| fragment == own);
        match (level, inside) {
            (0, _) | (_, true) => (level, root),
            _ => (ANY_TIME, root),
        }
    }
}

/// The two values of a choice by `first`.
fn arrow<'n>(net: &Net, node: &'n Node) -> Option<[&'n Input; 2]> {
    let [condition, first, later] = &node.inputs[..] else {
        return None;
    };
    let source = net.node(condition.port()?.node);
    let is_first = source.desc().role == Role::First && source.fragment == node.fragment;
    is_first.then_some([first, later])
}

fn is_total_delay(node: &Node) -> bool {
    let desc = node.desc();
    desc.role == Role::Delay
        && desc
            .outputs
            .iter()
            .any(|port| port.presence != Presence::Maybe)
}

/// The delays that are read too early by what must have a value in every cycle, in the order of the net.
fn read_early(net: &Net, levels: &Levels) -> Vec<NodeId> {
    let mut roots: Vec<NodeId> = sinks(net)
        .filter_map(|port| levels.root[port.node.index()])
        .collect();
    let acting = net
        .nodes
        .iter()
        .filter(|node| matches!(node.desc().role, Role::Actuator(_) | Role::Export));
    for node in acting {
        let seen = node
            .inputs
            .iter()
            .map(|input| levels.seen(net, node, input));
        roots.extend(seen.filter_map(|(_, root)| root));
    }
    roots.sort_unstable();
    roots.dedup();
    roots
}

/// What leaves the net, or decides what is active in it.
fn sinks(net: &Net) -> impl Iterator<Item = PortRef> + '_ {
    let exports = net.exports.iter().map(|export| export.source);
    let results = match &net.driver {
        Driver::Results(results) => &results[..],
        Driver::Ports { .. } => &[],
    };
    let results = results.iter().filter_map(|result| result.condition.port());
    let activations = net
        .fragments
        .iter()
        .filter_map(|fragment| match fragment.activation {
            Activation::When { condition, .. } => Some(condition),
            Activation::Always => None,
        });
    exports.chain(results).chain(activations)
}

fn finding(net: &Net, root: NodeId) -> Finding {
    let node = net.node(root);
    let flow = node.origin.flow.as_deref();
    let what = flow.map_or_else(|| "a flow".to_owned(), |flow| format!("`{flow}`"));
    Finding::new(
        Code::RPI5001,
        format!("{what} has no value in the first cycle"),
    )
    .at(node.origin.span, "there is no cycle before the first")
    .help("say what it is then: `first -> pre x`")
    .fix(Fix::maybe("give it a first value").insert_before(node.origin.span, first_value(node)))
}

/// How the text of a first value begins.
fn first_value(node: &Node) -> &'static str {
    use rpi_image::{Scalar, Type};
    match node.outputs.first() {
        Some(Type::One(Scalar::Bool)) => "false -> ",
        Some(Type::One(Scalar::Int)) => "0 -> ",
        _ => "0.0 -> ",
    }
}
