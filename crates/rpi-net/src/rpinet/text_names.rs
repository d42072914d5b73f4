//! Assigns names in the text to a net's nodes, fragments and border ports.

use super::build::{ACTIVATION, RESTART};
use super::names::PARENT;
use crate::fragment_tree::{FragmentTree, Item};
use crate::net::{Activation, FragmentId, Input, Net, NodeId, PortRef, Restart, Termination};
use std::collections::{BTreeSet, HashMap};

/// Names of all nodes, fragments and ports of a net in its text form.
pub(super) struct TextNames<'a> {
    net: &'a Net,
    tree: &'a FragmentTree,
    /// Names of nodes whose name in the text differs from that in the net, because the text form does not allow it or
    /// it is taken.
    node_names: HashMap<NodeId, String>,
    fragment_names: HashMap<FragmentId, String>,
    inputs: Vec<Border>,
    outputs: Vec<Border>,
}

/// In-ports, or out-ports, of a fragment in the text form.
#[derive(Clone, Default)]
struct Border {
    ports: Vec<(String, Input)>,
    /// Index in `ports` of the first port that carries a flow.
    port_of_flow: HashMap<PortRef, usize>,
}

impl<'a> TextNames<'a> {
    /// Assigns all names: first those of declared ports, then those of further ports that links across borders need.
    pub(super) fn new(net: &'a Net, tree: &'a FragmentTree) -> Self {
        let mut ports = TextNames {
            net,
            tree,
            node_names: HashMap::new(),
            fragment_names: HashMap::new(),
            inputs: vec![Border::default(); net.fragments.len()],
            outputs: vec![Border::default(); net.fragments.len()],
        };
        for fragment in net.fragment_ids() {
            ports.name_items(fragment);
            ports.declare(fragment);
        }
        for (scope, port) in flow_reads(net) {
            ports.route(scope, port);
        }
        ports
    }

    /// Returns the in-ports of a fragment in order, with names and sources.
    pub(super) fn inputs(&self, fragment: FragmentId) -> &[(String, Input)] {
        &self.inputs[fragment.index()].ports
    }

    /// Returns the out-ports of a fragment in order, with names and sources.
    pub(super) fn outputs(&self, fragment: FragmentId) -> &[(String, Input)] {
        &self.outputs[fragment.index()].ports
    }

    /// Returns the name of the in-port of a fragment that carries a flow; empty if there is none.
    pub(super) fn input(&self, fragment: FragmentId, port: PortRef) -> &str {
        self.inputs[fragment.index()].name_of(port)
    }

    /// Returns the name of the out-port of a fragment that carries a flow; empty if there is none.
    pub(super) fn output(&self, fragment: FragmentId, port: PortRef) -> &str {
        self.outputs[fragment.index()].name_of(port)
    }

    pub(super) fn node_name(&self, id: NodeId) -> &str {
        let own = || self.net.node(id).name.as_str();
        self.node_names.get(&id).map_or_else(own, String::as_str)
    }

    pub(super) fn fragment_name(&self, id: FragmentId) -> &str {
        let own = || self.net.fragment(id).name.as_str();
        self.fragment_names
            .get(&id)
            .map_or_else(own, String::as_str)
    }

    /// Assigns text names to the nodes and child fragments of a fragment. A name is changed if the text form does not
    /// allow it or another element has it.
    fn name_items(&mut self, fragment: FragmentId) {
        let mut taken = BTreeSet::from([PARENT.to_owned()]);
        for item in self.tree.items(fragment) {
            let own = match item {
                Item::Node(id) => &self.net.node(id).name,
                Item::Fragment(id) => &self.net.fragment(id).name,
            };
            let name = free_name(own, &taken);
            if name != *own {
                match item {
                    Item::Node(id) => drop(self.node_names.insert(id, name.clone())),
                    Item::Fragment(id) => drop(self.fragment_names.insert(id, name.clone())),
                }
            }
            taken.insert(name);
        }
    }

    fn declare(&mut self, id: FragmentId) {
        let fragment = self.net.fragment(id);
        let inputs = &mut self.inputs[id.index()];
        for port in &fragment.inputs {
            inputs.add(&port.name, port.source.clone());
        }
        if let Activation::When { condition, .. } = fragment.activation {
            inputs.add(ACTIVATION, Input::Port(condition));
        }
        if let Restart::Every(condition) = fragment.restart {
            inputs.add(RESTART, Input::Port(condition));
        }
        for port in &fragment.outputs {
            self.outputs[id.index()].add(&port.name, port.source.clone());
        }
    }

    /// Adds the ports on borders that a link from the flow `port` to a reader in the fragment `scope` needs.
    fn route(&mut self, scope: FragmentId, port: PortRef) {
        let (tree, origin) = (self.tree, self.net.node(port.node).fragment);
        let common = tree.common_ancestor(scope, origin);
        for fragment in tree.between(scope, common) {
            self.inputs[fragment.index()].add_if_missing("in", port);
        }
        for fragment in tree.between(origin, common) {
            self.outputs[fragment.index()].add_if_missing("out", port);
        }
    }
}

impl Border {
    fn add(&mut self, name: &str, source: Input) {
        if let Input::Port(port) = source {
            self.port_of_flow.entry(port).or_insert(self.ports.len());
        }
        let taken = self.ports.iter().map(|(n, _)| n.clone()).collect();
        self.ports.push((free_name(name, &taken), source));
    }

    /// Adds a port that carries a flow, unless there is one. `prefix` begins its name.
    fn add_if_missing(&mut self, prefix: &str, port: PortRef) {
        if !self.port_of_flow.contains_key(&port) {
            let mut number = self.ports.len();
            let name = |n: usize| format!("{prefix}{n}");
            while self.ports.iter().any(|(taken, _)| *taken == name(number)) {
                number += 1;
            }
            self.port_of_flow.insert(port, self.ports.len());
            self.ports.push((name(number), Input::Port(port)));
        }
    }

    fn name_of(&self, port: PortRef) -> &str {
        let index = self.port_of_flow.get(&port);
        index.map_or("", |k| self.ports[*k].0.as_str())
    }
}

/// Returns all flows that are read, each with the fragment that contains the reader.
fn flow_reads(net: &Net) -> impl Iterator<Item = (FragmentId, PortRef)> + '_ {
    let nodes = net.nodes.iter().flat_map(|n| {
        let inputs = n.inputs.iter().filter_map(Input::port);
        inputs.map(|p| (n.fragment, p))
    });
    let borders = net.fragment_ids().flat_map(move |id| {
        let fragment = net.fragment(id);
        let outside = fragment.parent.unwrap_or(FragmentId::ROOT);
        let activation = match fragment.activation {
            Activation::When { condition, .. } => Some(condition),
            Activation::Always => None,
        };
        let restart = match fragment.restart {
            Restart::Every(condition) => Some(condition),
            Restart::Never | Restart::OnActivation => None,
        };
        let inputs = fragment.inputs.iter().filter_map(|p| p.source.port());
        let outputs = fragment.outputs.iter().filter_map(|p| p.source.port());
        let inputs = inputs.chain(activation).chain(restart);
        inputs
            .map(move |p| (outside, p))
            .chain(outputs.map(move |p| (id, p)))
    });
    let driver = match &net.termination {
        Termination::Ports { terminate, fail } => [terminate, fail].map(Option::as_ref),
        Termination::Results(_) => [None, None],
    };
    let driver = driver.into_iter().flatten().filter_map(Input::port);
    nodes
        .chain(borders)
        .chain(driver.map(|p| (FragmentId::ROOT, p)))
}

/// Returns a name similar to `preferred` that is not in `taken` and contains only letters, digits, `_` and `:`.
fn free_name(preferred: &str, taken: &BTreeSet<String>) -> String {
    let is_valid = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == ':';
    let clean: String = preferred
        .chars()
        .map(|c| if is_valid(c) { c } else { '_' })
        .collect();
    let clean = if clean.is_empty() { "_".into() } else { clean };
    let numbered = (2..).map(|n| format!("{clean}_{n}"));
    let mut names = std::iter::once(clean.clone()).chain(numbered);
    names.find(|name| !taken.contains(name)).unwrap_or(clean)
}
