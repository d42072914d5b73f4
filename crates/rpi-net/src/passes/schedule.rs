//! Schedule: a topological order per fragment in which declaration order breaks ties.
//!
//! Of all ready items, the one declared first comes next. The reference executor orders its primitives in the same way,
//! and the result is deterministic.

use crate::fragment_tree::Item;
use crate::net::{FragmentId, Net, NodeId};
use crate::passes::clocks;
use crate::passes::dependencies::{Dependencies, Graph};
use crate::verify_error::VerifyError;
use petgraph::Direction::Incoming;
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use smallvec::SmallVec;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Order in which the nodes of a net are evaluated in a cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Schedule {
    /// For each fragment, its content in order of evaluation for each entry in a cycle. Only fragments that group the
    /// operations of a clock are entered more than once.
    runs: Vec<SmallVec<[Vec<Item>; 1]>>,
}

impl Schedule {
    /// Computes the schedule; `None` if there is a dependency cycle, which the causality pass reports.
    #[must_use]
    pub fn new(net: &Net, dependencies: &Dependencies) -> Option<Self> {
        let mut runs = vec![SmallVec::new(); net.fragments.len()];
        let levels = dependencies.fragments();
        for level in levels.filter(|f| !dependencies.is_clock(*f)) {
            let graph = dependencies.graph(level);
            let is_clock = |item: &Item| match item {
                Item::Fragment(f) => dependencies.is_clock(*f),
                Item::Node(_) => false,
            };
            if graph.node_weights().any(is_clock) {
                for (fragment, run) in clocks::runs(net, dependencies, level)? {
                    runs[fragment.index()].push(run);
                }
            } else {
                runs[level.index()].push(topological_order(graph)?);
            }
        }
        Some(Schedule { runs })
    }

    /// Returns the content of a fragment in order of evaluation for one of its entries in a cycle. `time` counts the
    /// entries from 0.
    #[must_use]
    pub fn run(&self, fragment: FragmentId, time: usize) -> &[Item] {
        let run = self.runs[fragment.index()].get(time);
        run.map_or(&[], Vec::as_slice)
    }

    /// Returns the number of times that a fragment is entered in a cycle.
    #[must_use]
    pub fn entry_count(&self, fragment: FragmentId) -> usize {
        self.runs[fragment.index()].len()
    }

    /// Returns all nodes and fragments in order of evaluation. A fragment comes before its contents, each time it is
    /// entered.
    pub fn items(&self) -> impl Iterator<Item = Item> + '_ {
        let mut times = vec![0_usize; self.runs.len()];
        let mut open = vec![self.run(FragmentId::ROOT, 0).iter()];
        std::iter::from_fn(move || {
            loop {
                let Some(item) = open.last_mut()?.next() else {
                    open.pop();
                    continue;
                };
                if let Item::Fragment(f) = item {
                    open.push(self.run(*f, times[f.index()]).iter());
                    times[f.index()] += 1;
                }
                return Some(*item);
            }
        })
    }

    /// Returns all nodes in order of evaluation, including those in inner fragments.
    pub fn nodes(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.items().filter_map(|item| match item {
            Item::Node(id) => Some(id),
            Item::Fragment(_) => None,
        })
    }
}

/// Returns the vertices in topological order, lower vertex numbers first where possible (Kahn 1962); `None` if the
/// graph has a cycle.
fn topological_order(graph: &Graph) -> Option<Vec<Item>> {
    let mut waiting: Vec<usize> = graph
        .node_indices()
        .map(|v| graph.edges_directed(v, Incoming).count())
        .collect();
    let mut ready: BinaryHeap<Reverse<NodeIndex>> = graph
        .node_indices()
        .filter(|v| waiting[v.index()] == 0)
        .map(Reverse)
        .collect();
    let mut order = Vec::with_capacity(graph.node_count());
    while let Some(Reverse(v)) = ready.pop() {
        order.push(graph[v]);
        for reader in graph.edges(v).map(|e| e.target()) {
            waiting[reader.index()] -= 1;
            if waiting[reader.index()] == 0 {
                ready.push(Reverse(reader));
            }
        }
    }
    (order.len() == graph.node_count()).then_some(order)
}

/// Checks that each node and fragment occurs once in the schedule, after all those that it depends on.
///
/// # Errors
/// Returns the first node or fragment that is missing, scheduled twice or too early.
pub fn verify(
    net: &Net,
    dependencies: &Dependencies,
    schedule: &Schedule,
) -> Result<(), VerifyError> {
    let mut places = Positions::new(net);
    for (at, item) in schedule.items().enumerate() {
        let is_clock = matches!(item, Item::Fragment(f) if net.fragment(f).is_clock);
        if !places.record(item, at) && !is_clock {
            return Err(VerifyError::new(format!(
                "schedule: {item:?} is scheduled twice"
            )));
        }
    }
    for fragment in dependencies.fragments() {
        let graph = dependencies.graph(fragment);
        for edge in graph.edge_references() {
            let (source, target) = (graph[edge.source()], graph[edge.target()]);
            let is_activation =
                |item: Item| matches!(item, Item::Fragment(f) if dependencies.is_clock(f));
            if is_activation(source) || is_activation(target) {
                continue;
            }
            if places.position(source) >= places.position(target) {
                return Err(VerifyError::new(format!(
                    "schedule: {target:?} is scheduled before {source:?}, which it reads"
                )));
            }
        }
        let is_there = |item: &Item| {
            matches!(item, Item::Fragment(f) if dependencies.is_clock(*f))
                || places.position(*item) != usize::MAX
        };
        if !graph.node_weights().all(is_there) {
            let name = net.path(fragment, "");
            return Err(VerifyError::new(format!(
                "schedule: missing items in `{name}`"
            )));
        }
    }
    Ok(())
}

/// Position of each node and fragment in the order of evaluation; `usize::MAX` if it does not occur.
struct Positions {
    nodes: Vec<usize>,
    fragments: Vec<usize>,
}

impl Positions {
    fn new(net: &Net) -> Self {
        Positions {
            nodes: vec![usize::MAX; net.nodes.len()],
            fragments: vec![usize::MAX; net.fragments.len()],
        }
    }

    /// Records the position `at` of a node or fragment. Returns false if it already had a position.
    fn record(&mut self, item: Item, at: usize) -> bool {
        let place = match item {
            Item::Node(n) => &mut self.nodes[n.index()],
            Item::Fragment(f) => &mut self.fragments[f.index()],
        };
        std::mem::replace(place, at) == usize::MAX
    }

    fn position(&self, item: Item) -> usize {
        match item {
            Item::Node(n) => self.nodes[n.index()],
            Item::Fragment(f) => self.fragments[f.index()],
        }
    }
}
