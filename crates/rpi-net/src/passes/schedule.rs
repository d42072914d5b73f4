//! The order of evaluation: a topological order per fragment in which declaration order breaks ties.
//!
//! Of all items that wait for nothing more, the one declared first comes next. That is the order in which the reference
//! executor places its primitives, and it is the same in every run.

use crate::net::{FragmentId, Net, NodeId};
use crate::passes::dependencies::{Dependencies, Graph};
use crate::tree::Item;
use crate::violation::Violation;
use petgraph::Direction::Incoming;
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The order of evaluation of a net.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Schedule {
    items: Vec<Vec<Item>>,
}

impl Schedule {
    /// The schedule, unless something depends on itself (then the causality pass says what).
    #[must_use]
    pub fn new(dependencies: &Dependencies) -> Option<Self> {
        let items: Option<Vec<_>> = dependencies
            .fragments()
            .map(|f| order(dependencies.graph(f)))
            .collect();
        Some(Schedule { items: items? })
    }

    /// The items of a fragment in order of evaluation.
    #[must_use]
    pub fn items(&self, fragment: FragmentId) -> &[Item] {
        &self.items[fragment.index()]
    }

    /// All nodes in order of evaluation, each fragment's in its place.
    pub fn nodes(&self) -> impl Iterator<Item = NodeId> + '_ {
        let mut open = vec![self.items(FragmentId::ROOT).iter()];
        std::iter::from_fn(move || {
            loop {
                match open.last_mut()?.next() {
                    Some(Item::Node(n)) => return Some(*n),
                    Some(Item::Fragment(f)) => open.push(self.items(*f).iter()),
                    None => {
                        open.pop();
                    }
                }
            }
        })
    }
}

/// Kahn's algorithm (1962) with a heap over vertex numbers; none if the graph has a cycle.
fn order(graph: &Graph) -> Option<Vec<Item>> {
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

/// Checks a schedule: each item once in its fragment, and after everything it waits for.
///
/// # Errors
/// The first item that is missing, doubled or too early.
pub fn verify(
    net: &Net,
    dependencies: &Dependencies,
    schedule: &Schedule,
) -> Result<(), Violation> {
    let mut places = Places::new(net);
    for fragment in net.fragment_ids() {
        let graph = dependencies.graph(fragment);
        let items = schedule.items(fragment);
        places.fill(items);
        let all = graph.node_weights().all(|item| places.holds(items, *item));
        if !all || graph.node_count() != items.len() {
            let name = net.path(fragment, "");
            return Err(Violation::new(format!(
                "schedule: items missing or doubled in `{name}`"
            )));
        }
        for edge in graph.edge_references() {
            let (source, target) = (graph[edge.source()], graph[edge.target()]);
            if places.of(source) >= places.of(target) {
                return Err(Violation::new(format!(
                    "schedule: {target:?} comes before {source:?} which it reads"
                )));
            }
        }
    }
    Ok(())
}

/// For each item of a net its place in the order of its fragment.
struct Places {
    nodes: Vec<usize>,
    fragments: Vec<usize>,
}

impl Places {
    fn new(net: &Net) -> Self {
        Places {
            nodes: vec![usize::MAX; net.nodes.len()],
            fragments: vec![usize::MAX; net.fragments.len()],
        }
    }

    fn fill(&mut self, items: &[Item]) {
        for (at, item) in items.iter().enumerate() {
            match item {
                Item::Node(n) => self.nodes[n.index()] = at,
                Item::Fragment(f) => self.fragments[f.index()] = at,
            }
        }
    }

    fn of(&self, item: Item) -> usize {
        match item {
            Item::Node(n) => self.nodes[n.index()],
            Item::Fragment(f) => self.fragments[f.index()],
        }
    }

    /// Whether the item stands among these, where it is said to.
    fn holds(&self, items: &[Item], item: Item) -> bool {
        items.get(self.of(item)) == Some(&item)
    }
}
