//! Conversion of nets to programs: a `.rpinet` file becomes a readable program that can be edited and compiled.
//!
//! Every primitive becomes one equation and keeps its name if that is a valid name. Short constants are written in
//! place. A primitive is written as an operator if the compiler translates the operator to the same primitive, so the
//! compiled program is the original net, node by node. This module must not depend on the checker.

mod constants;
mod links;
mod merge;
mod names;
mod nodes;
mod operators;
mod order;
mod results;
mod values;

use std::collections::BTreeSet;

use rpi_net::passes::mark_live::mark_live;
use rpi_net::passes::{FlowPresence, Presences, analyse};
use rpi_net::{
    AbsentPolicy, Activation, FragmentId, FragmentTree, Input, Net, NodeId, PortRef, Restart,
};
use rpi_syntax::Dialect;

use merge::MergedNet;
use names::Names;

/// Program that was made from a net, with the names of the net's nodes in the program.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ImportedProgram {
    /// Text of the program, which has one command.
    pub text: String,
    /// For each named node, its path in the net and its path in the compiled program.
    pub names: Vec<(String, String)>,
}

/// Converts a net to the text of a program with one command.
#[must_use]
pub fn to_program(net: &Net) -> String {
    import(net).text
}

/// Converts a net to a program with one command, and returns also the names of the net's nodes in the program.
#[must_use]
pub fn import(net: &Net) -> ImportedProgram {
    let merged = merge::merge_writers(net);
    let writer = Writer::new(&merged);
    let text = writer.command();
    ImportedProgram {
        text: rpi_syntax::format(&text, Dialect::Rpi).unwrap_or(text),
        names: writer.renamed(net, &merged.original),
    }
}

/// Writer of the program text for one net.
struct Writer<'n> {
    net: &'n Net,
    tree: FragmentTree,
    names: Names,
    /// Presence of the net's flows in each cycle; `None` if the compiler passes reported an error.
    presences: Option<Presences>,
    /// Constant nodes that become literals within the expressions that read them, without equations of their own.
    constants: BTreeSet<NodeId>,
    /// Nodes that select the first present value of merged writers. They become operands of the expressions that read
    /// them, without equations of their own.
    choices: &'n BTreeSet<NodeId>,
}

impl<'n> Writer<'n> {
    fn new(merged: &'n MergedNet) -> Self {
        let net = &merged.net;
        // The flow of a delay is declared optional, so everything that reads it is optional as well, even if the net
        // proves presence.
        let may_be_absent = |port: PortRef| nodes::is_delay(net.node(port.node));
        Writer {
            tree: FragmentTree::new(net),
            names: Names::new(net, &unused(net)),
            presences: analyse(net.clone(), may_be_absent)
                .ok()
                .map(|a| a.presences),
            constants: constants::inlined_constants(net),
            choices: &merged.selectors,
            net,
        }
    }

    fn command(&self) -> String {
        let body = self.body(FragmentId::ROOT);
        let ends = self.results();
        let Net {
            name,
            nodes,
            fragments,
            ..
        } = self.net;
        let (count, inner) = (nodes.len(), fragments.len() - 1);
        let head = format!("-- The net `{name}`: {count} primitives, {inner} fragments.\n");
        format!("{head}command {} ()\n{body}{ends}tel\n", self.names.command)
    }

    /// Returns the declarations, the keyword `let` and the equations of a fragment as program text.
    fn body(&self, fragment: FragmentId) -> String {
        let mut declared = String::new();
        let mut equations = String::new();
        for node in order::topological_order(self.net, fragment) {
            if !self.is_inlined(node) {
                declared.extend(self.declaration(node));
                equations.push_str(&self.equation(node));
            }
        }
        for child in self.children(fragment) {
            equations.push_str(&self.fragment(child));
        }
        let var = if declared.is_empty() { "" } else { "var\n" };
        format!("{var}{declared}let\n{equations}")
    }

    fn children(&self, fragment: FragmentId) -> impl Iterator<Item = FragmentId> + '_ {
        let is_child = move |id: &FragmentId| self.net.fragment(*id).parent == Some(fragment);
        self.net.fragment_ids().filter(is_child)
    }

    fn fragment(&self, id: FragmentId) -> String {
        let fragment = self.net.fragment(id);
        let around = fragment.parent.unwrap_or(FragmentId::ROOT);
        let restart = match fragment.restart {
            Restart::OnActivation => " restart",
            Restart::Never | Restart::Every(_) => "",
        };
        let when = match &fragment.activation {
            Activation::Always => String::new(),
            Activation::When {
                condition,
                if_absent: absent,
            } => {
                let otherwise = (*absent == AbsentPolicy::Active).to_string();
                let condition = self.total(*condition, around, &otherwise);
                format!("when {condition}{restart}")
            }
        };
        let (name, body) = (self.names.fragment(id), self.body(id));
        format!("\nfragment {name} {when}\n{body}tel\n")
    }

    /// Returns the expression for a flow as read from the fragment `at`. It ends with `?? absent` if the flow may be
    /// absent there.
    fn total(&self, port: PortRef, at: FragmentId, absent: &str) -> String {
        let flow = self.flow(port, at);
        let is_total = self.presences.as_ref().is_some_and(|presences| {
            let seen = presences.presence_at(self.net, &self.tree, at, &Input::Port(port));
            seen == FlowPresence::Total
        });
        match is_total {
            true => flow,
            false => format!("{flow} ?? {absent}"),
        }
    }

    /// Returns whether a node has no equation because its expression is written where the node is read.
    fn is_inlined(&self, id: NodeId) -> bool {
        self.constants.contains(&id) || self.choices.contains(&id)
    }

    /// Returns the old and new paths of the named nodes of the original net. `old` has for each node of the merged net
    /// that of the original one.
    fn renamed(&self, original: &Net, old: &[Option<NodeId>]) -> Vec<(String, String)> {
        let named = self.net.node_ids().filter(|id| !self.is_inlined(*id));
        let both = named.filter_map(|id| Some((old[id.index()]?, id)));
        both.map(|(old, new)| {
            let node = original.node(old);
            (original.path(node.fragment, &node.name), self.new_path(new))
        })
        .collect()
    }

    fn new_path(&self, id: NodeId) -> String {
        let mut parts = self.fragment_path(self.net.node(id).fragment);
        parts.push(self.names.node(id));
        parts.join("/")
    }

    /// Returns the names in the program of a fragment and its enclosing fragments, outermost first.
    fn fragment_path(&self, id: FragmentId) -> Vec<&str> {
        let mut parts: Vec<&str> = self
            .net
            .ancestors(id)
            .filter(|id| *id != FragmentId::ROOT)
            .map(|id| self.names.fragment(id))
            .collect();
        parts.reverse();
        parts
    }
}

/// Returns the nodes without effect that nothing reads, and one node of each dependency cycle that only feeds itself.
/// Their names get a leading `_`, so that the compiler does not warn about them.
fn unused(net: &Net) -> BTreeSet<NodeId> {
    let live = mark_live(net);
    let inputs = net.nodes.iter().flat_map(|node| &node.inputs);
    let read: BTreeSet<NodeId> = inputs.filter_map(Input::port).map(|p| p.node).collect();
    let dead = || net.node_ids().filter(|id| !live[id.index()]);
    let (in_rings, ends): (Vec<NodeId>, Vec<NodeId>) = dead().partition(|id| read.contains(id));
    let mut used = vec![false; net.nodes.len()];
    let mut unused = BTreeSet::new();
    for id in ends.into_iter().chain(in_rings) {
        if !used[id.index()] {
            unused.insert(id);
            mark_sources(net, id, &mut used);
        }
    }
    unused
}

/// Marks a node and all nodes that it reads, directly or indirectly, by their indices in `marked`.
fn mark_sources(net: &Net, id: NodeId, marked: &mut [bool]) {
    let mut open = vec![id];
    while let Some(id) = open.pop() {
        if !std::mem::replace(&mut marked[id.index()], true) {
            let inputs = net.node(id).inputs.iter();
            open.extend(inputs.filter_map(Input::port).map(|port| port.node));
        }
    }
}
