//! What must be computed before what: one graph per fragment.
//!
//! The vertices of a fragment's graph are its nodes and its child fragments. A child fragment is one vertex: it waits
//! for its activation and for everything that is read from inside it or declared as its in-port, whatever reads it
//! there; so a `pre` breaks a cycle only at the level at which the cycle runs (M6). A delay in the graph's own fragment
//! waits for nothing: it is latched after the cycle.
//!
//! A fragment that gathers operations of one clock is transparent: its operations are vertices of the graph around it, which
//! wait for what they read, and for the clock. The vertex of such a fragment stands for its activation alone.

use crate::net::{Activation, FragmentId, Input, Net, NodeId, PortRef, Restart};
use crate::tree::{Item, Tree};
use petgraph::graph::{DiGraph, NodeIndex};
use rpi_image::{Role, Value};

/// Who reads a flow.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Reader {
    /// An in-port of a node, by index.
    Input(NodeId, u32),
    /// The activation of a fragment.
    Activation(FragmentId),
    /// The restart condition of a fragment.
    Restart(FragmentId),
    /// A declared in-port of a fragment, by index.
    InPort(FragmentId, u32),
}

/// One link that makes an item wait for another.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Dependence {
    /// The flow that is read.
    pub source: PortRef,
    /// Who reads it.
    pub reader: Reader,
}

/// The dependency graphs of all fragments of a net; edges run from what is read to who reads it.
#[derive(Clone, Debug)]
pub struct Dependencies {
    graphs: Vec<Graph>,
    is_clock: Vec<bool>,
}

/// Vertices are numbered in declaration order.
pub(crate) type Graph = DiGraph<Item, Dependence>;

impl Dependencies {
    /// The graphs of a net.
    #[must_use]
    pub fn new(net: &Net, tree: &Tree) -> Self {
        let mut builder = Builder::new(net, tree);
        for (reader, place, source) in links(net) {
            builder.connect(reader, place, source);
        }
        let is_clock = net.fragments.iter().map(|fragment| fragment.is_clock);
        Dependencies {
            graphs: builder.graphs,
            is_clock: is_clock.collect(),
        }
    }

    /// The graphs of no net.
    pub(crate) fn none() -> Self {
        Dependencies {
            graphs: Vec::new(),
            is_clock: Vec::new(),
        }
    }

    pub(crate) fn graph(&self, fragment: FragmentId) -> &Graph {
        &self.graphs[fragment.index()]
    }

    /// Whether a fragment only gathers operations of one clock.
    pub(crate) fn is_clock(&self, fragment: FragmentId) -> bool {
        self.is_clock[fragment.index()]
    }

    /// All fragments.
    pub(crate) fn fragments(&self) -> impl Iterator<Item = FragmentId> + use<> {
        (0..u32::try_from(self.graphs.len()).unwrap_or(u32::MAX)).map(FragmentId)
    }
}

/// Every reading of a flow that counts for the order: who reads, the fragment in which the reading stands, and what.
fn links(net: &Net) -> impl Iterator<Item = (Reader, FragmentId, PortRef)> + '_ {
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
    tree: &'a Tree,
    graphs: Vec<Graph>,
    node_at: Vec<NodeIndex>,
    fragment_at: Vec<NodeIndex>,
}

impl<'a> Builder<'a> {
    fn new(net: &'a Net, tree: &'a Tree) -> Self {
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

    /// Adds a fragment's graph, its vertices in declaration order.
    fn add_vertices(&mut self, fragment: FragmentId) {
        if self.net.fragment(fragment).is_clock {
            return self.graphs.push(Graph::new());
        }
        let items = self.tree.items_through(self.net, fragment);
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

    /// Lets all that stands in the fragment of a clock wait for the clock.
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
            graph.add_edge(from, to, Dependence { source, reader });
        }
    }

    /// The innermost fragment around one, or it itself, that has a graph.
    fn level(&self, fragment: FragmentId) -> FragmentId {
        let mut around = self.net.enclosing(fragment);
        let level = around.find(|around| !self.net.fragment(*around).is_clock);
        level.unwrap_or(FragmentId::ROOT)
    }

    /// The fragment that stands for `inner` at a level: the outermost below it that is no clock's.
    fn child_towards(&self, level: FragmentId, inner: FragmentId) -> Option<FragmentId> {
        let below = self.tree.between(inner, level);
        below.filter(|f| !self.net.fragment(*f).is_clock).last()
    }

    /// Adds the edge of one reading, in the innermost fragment that encloses both ends.
    fn connect(&mut self, reader: Reader, place: FragmentId, source: PortRef) {
        let origin = self.net.node(source.node).fragment;
        let level = self.level(self.tree.common(place, origin));
        let Some(to) = self.reading_vertex(reader, level, place) else {
            return;
        };
        let from = match self.child_towards(level, origin) {
            Some(child) => self.fragment_at[child.index()],
            None => self.node_at[source.node.index()],
        };
        self.graphs[level.index()].add_edge(from, to, Dependence { source, reader });
    }

    /// The vertex that waits at this level; none for a delay, which waits for nothing.
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
    /// An in-port that reads a constant.
    #[must_use]
    pub fn constant(value: Value) -> Input {
        Input::Const(Box::new(value))
    }

    /// The flow that is read, unless it is a constant or nothing.
    #[must_use]
    pub fn port(&self) -> Option<PortRef> {
        match self {
            Input::Port(port) => Some(*port),
            Input::Open | Input::Const(_) => None,
        }
    }
}
