//! Dependency graphs: for each fragment, which items must be computed before which.
//!
//! The vertices of a fragment's graph are its nodes and its child fragments. A child fragment is one vertex: it waits
//! for its activation and for every flow that is read inside it or declared as its in-port, whichever node reads it. So
//! a `pre` breaks a dependency cycle only at the level of that cycle (M6). A delay directly in the fragment waits for
//! nothing, since it is latched after the cycle.
//!
//! A fragment that groups operations of one clock is transparent: its operations are vertices of the enclosing graph
//! and wait for their inputs and for the clock. The vertex of such a fragment represents only its activation.

use crate::fragment_tree::{FragmentTree, Item};
use crate::net::{Activation, FragmentId, Input, Net, NodeId, PortRef, Restart};
use petgraph::graph::{DiGraph, NodeIndex};
use rpi_image::{Role, Value};

/// Reader of a flow: an in-port of a node or fragment, or a condition of a fragment.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Reader {
    /// In-port of a node, with its index.
    Input(NodeId, u32),
    /// Condition that decides in each cycle whether the fragment is active.
    Activation(FragmentId),
    /// Condition under which the fragment restarts with its initial state.
    Restart(FragmentId),
    /// Declared in-port of a fragment, with its index.
    InPort(FragmentId, u32),
}

/// Label of an edge in a dependency graph: one node or fragment depends on another because it reads a flow.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Dependency {
    /// Out-port whose flow is read.
    pub source: PortRef,
    /// In-port or condition that reads the flow.
    pub reader: Reader,
}

/// Dependency graphs of all fragments of a net. Each edge leads from the source of a flow to its reader.
#[derive(Clone, Debug)]
pub struct Dependencies {
    graphs: Vec<Graph>,
    is_clock: Vec<bool>,
}

/// Dependency graph of a fragment. Its vertices are nodes and child fragments, in declaration order.
pub(crate) type Graph = DiGraph<Item, Dependency>;

impl Dependencies {
    /// Builds the dependency graphs of a net.
    #[must_use]
    pub fn new(net: &Net, tree: &FragmentTree) -> Self {
        let mut builder = Builder::new(net, tree);
        for (reader, place, source) in reads(net) {
            builder.connect(reader, place, source);
        }
        let is_clock = net.fragments.iter().map(|fragment| fragment.is_clock);
        Dependencies {
            graphs: builder.graphs,
            is_clock: is_clock.collect(),
        }
    }

    /// Creates an empty placeholder without graphs.
    pub(crate) fn empty() -> Self {
        Dependencies {
            graphs: Vec::new(),
            is_clock: Vec::new(),
        }
    }

    pub(crate) fn graph(&self, fragment: FragmentId) -> &Graph {
        &self.graphs[fragment.index()]
    }

    /// Returns whether a fragment only groups the operations of one clock. Such a fragment has no graph of its own.
    pub(crate) fn is_clock(&self, fragment: FragmentId) -> bool {
        self.is_clock[fragment.index()]
    }

    /// Returns all fragment indices in ascending order.
    pub(crate) fn fragments(&self) -> impl Iterator<Item = FragmentId> + use<> {
        (0..u32::try_from(self.graphs.len()).unwrap_or(u32::MAX)).map(FragmentId)
    }
}

/// Returns all reads that affect the order of evaluation: the reader, the fragment that contains it, and the flow.
fn reads(net: &Net) -> impl Iterator<Item = (Reader, FragmentId, PortRef)> + '_ {
    let nodes = net.node_ids().flat_map(move |id| {
        let node = net.node(id);
        let inputs = (0..).zip(&node.inputs);
        inputs.filter_map(move |(k, input)| {
            Some((Reader::Input(id, k), node.fragment, input.port()?))
        })
    });
    let borders = net.fragment_ids().flat_map(move |id| {
        let outside = net.fragment(id).parent;
        border_links(net, id).filter_map(move |(reader, source)| Some((reader, outside?, source)))
    });
    nodes.chain(borders)
}

fn border_links(net: &Net, id: FragmentId) -> impl Iterator<Item = (Reader, PortRef)> + '_ {
    let fragment = net.fragment(id);
    let activation = match fragment.activation {
        Activation::Always => None,
        Activation::When { condition, .. } => Some((Reader::Activation(id), condition)),
    };
    let restart = match fragment.restart {
        Restart::Every(condition) => Some((Reader::Restart(id), condition)),
        Restart::Never | Restart::OnActivation => None,
    };
    let ports = (0..).zip(&fragment.inputs);
    let ports = ports.filter_map(move |(k, p)| Some((Reader::InPort(id, k), p.source.port()?)));
    activation.into_iter().chain(restart).chain(ports)
}

struct Builder<'a> {
    net: &'a Net,
    tree: &'a FragmentTree,
    graphs: Vec<Graph>,
    node_at: Vec<NodeIndex>,
    fragment_at: Vec<NodeIndex>,
}

impl<'a> Builder<'a> {
    fn new(net: &'a Net, tree: &'a FragmentTree) -> Self {
        let mut builder = Builder {
            net,
            tree,
            graphs: Vec::with_capacity(net.fragments.len()),
            node_at: vec![NodeIndex::default(); net.nodes.len()],
            fragment_at: vec![NodeIndex::default(); net.fragments.len()],
        };
        for fragment in net.fragment_ids() {
            builder.add_vertices(fragment);
        }
        for fragment in net.fragment_ids().filter(|id| net.fragment(*id).is_clock) {
            builder.connect_clock(fragment);
        }
        builder
    }

    /// Adds the graph of a fragment with its vertices, and without edges.
    fn add_vertices(&mut self, fragment: FragmentId) {
        if self.net.fragment(fragment).is_clock {
            return self.graphs.push(Graph::new());
        }
        let items = self.tree.items_through_clocks(self.net, fragment);
        let mut graph = Graph::with_capacity(items.len(), 2 * items.len());
        for item in items {
            let at = graph.add_node(item);
            match item {
                Item::Node(n) => self.node_at[n.index()] = at,
                Item::Fragment(f) => self.fragment_at[f.index()] = at,
            }
        }
        self.graphs.push(graph);
    }

    /// Adds edges that make all contents of a clock fragment depend on the condition of the clock.
    fn connect_clock(&mut self, clock: FragmentId) {
        let Activation::When { condition, .. } = self.net.fragment(clock).activation else {
            return;
        };
        let (from, level) = (self.fragment_at[clock.index()], self.level(clock));
        let nodes = self.tree.nodes(clock).iter();
        let nodes = nodes.map(|node| self.node_at[node.index()]);
        let children = self.tree.children(clock).iter();
        let children = children.map(|child| self.fragment_at[child.index()]);
        let graph = &mut self.graphs[level.index()];
        for to in nodes.chain(children) {
            let reader = Reader::Activation(clock);
            let source = condition;
            graph.add_edge(from, to, Dependency { source, reader });
        }
    }

    /// Returns the innermost fragment that is or encloses `fragment` and has a dependency graph of its own. Fragments
    /// that only group the operations of a clock have none.
    fn level(&self, fragment: FragmentId) -> FragmentId {
        let mut around = self.net.ancestors(fragment);
        let level = around.find(|around| !self.net.fragment(*around).is_clock);
        level.unwrap_or(FragmentId::ROOT)
    }

    /// Returns the fragment that is the vertex of `inner` in the graph of `level`: the outermost fragment around
    /// `inner` and below `level` that is not a clock. `None` if all fragments between them are clocks.
    fn child_towards(&self, level: FragmentId, inner: FragmentId) -> Option<FragmentId> {
        let below = self.tree.between(inner, level);
        below.filter(|f| !self.net.fragment(*f).is_clock).last()
    }

    /// Adds the edge of one read to the graph of the innermost fragment that encloses source and reader. `place` is the
    /// fragment that contains the reader.
    fn connect(&mut self, reader: Reader, place: FragmentId, source: PortRef) {
        let origin = self.net.node(source.node).fragment;
        let level = self.level(self.tree.common_ancestor(place, origin));
        let Some(to) = self.reading_vertex(reader, level, place) else {
            return;
        };
        let from = match self.child_towards(level, origin) {
            Some(child) => self.fragment_at[child.index()],
            None => self.node_at[source.node.index()],
        };
        self.graphs[level.index()].add_edge(from, to, Dependency { source, reader });
    }

    /// Returns the vertex in the graph of `level` that must wait for the flow because of the reader; `None` for a
    /// delay, which waits for nothing. `place` is the fragment that contains the reader.
    fn reading_vertex(
        &self,
        reader: Reader,
        level: FragmentId,
        place: FragmentId,
    ) -> Option<NodeIndex> {
        if let Some(child) = self.child_towards(level, place) {
            return Some(self.fragment_at[child.index()]);
        }
        match reader {
            Reader::Input(n, _) if self.net.node(n).desc().role == Role::Delay => None,
            Reader::Input(n, _) => Some(self.node_at[n.index()]),
            Reader::Activation(f) | Reader::Restart(f) | Reader::InPort(f, _) => {
                Some(self.fragment_at[f.index()])
            }
        }
    }
}

impl Input {
    /// Creates a source with a constant value.
    #[must_use]
    pub fn constant(value: Value) -> Input {
        Input::Const(Box::new(value))
    }

    /// Returns the out-port that is read; `None` for a constant or an unconnected in-port.
    #[must_use]
    pub fn port(&self) -> Option<PortRef> {
        match self {
            Input::Port(port) => Some(*port),
            Input::Unconnected | Input::Const(_) => None,
        }
    }
}
