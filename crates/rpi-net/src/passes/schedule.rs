//! The order of evaluation: a topological order per fragment in which declaration order breaks ties.
//!
//! Of all items that wait for nothing more, the one declared first comes next. That is the order in which the reference
//! executor places its primitives, and it is the same in every run.

use crate::net::{FragmentId, Net, NodeId};
use crate::passes::clocks;
use crate::passes::dependencies::{Dependencies, Graph};
use crate::tree::Item;
use crate::violation::Violation;
use petgraph::Direction::Incoming;
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use smallvec::SmallVec;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The order of evaluation of a net.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Schedule {
    /// Of each fragment what runs whenever it is entered. Fragments are entered once in a cycle, but for those of clocks.
    runs: Vec<SmallVec<[Vec<Item>; 1]>>,
}

impl Schedule {
    /// The schedule, unless something depends on itself (then the causality pass says what).
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
                runs[level.index()].push(order(graph)?);
            }
        }
        Some(Schedule { runs })
    }

    /// What runs in a fragment when it is entered for the time of this number in a cycle, from 0, in order of evaluation.
    #[must_use]
    pub fn run(&self, fragment: FragmentId, time: usize) -> &[Item] {
        let run = self.runs[fragment.index()].get(time);
        run.map_or(&[], Vec::as_slice)
    }

    /// How often a fragment is entered in a cycle.
    #[must_use]
    pub fn times(&self, fragment: FragmentId) -> usize {
        self.runs[fragment.index()].len()
    }

    /// All items in order of evaluation, each fragment before what is in it, whenever it is entered.
    pub fn walk(&self) -> impl Iterator<Item = Item> + '_ {
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

    /// All nodes in order of evaluation, each fragment's in its place.
    pub fn nodes(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.walk().filter_map(|item| match item {
            Item::Node(id) => Some(id),
            Item::Fragment(_) => None,
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
    for (at, item) in schedule.walk().enumerate() {
        let is_clock = matches!(item, Item::Fragment(f) if net.fragment(f).is_clock);
        if !places.put(item, at) && !is_clock {
            return Err(Violation::new(format!("schedule: {item:?} is doubled")));
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
            if places.of(source) >= places.of(target) {
                return Err(Violation::new(format!(
                    "schedule: {target:?} comes before {source:?} which it reads"
                )));
            }
        }
        let is_there = |item: &Item| {
            matches!(item, Item::Fragment(f) if dependencies.is_clock(*f))
                || places.of(*item) != usize::MAX
        };
        if !graph.node_weights().all(is_there) {
            let name = net.path(fragment, "");
            return Err(Violation::new(format!(
                "schedule: items missing in `{name}`"
            )));
        }
    }
    Ok(())
}

/// For each item of a net its place in the order.
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

    /// Notes the place of an item; false if it has one.
    fn put(&mut self, item: Item, at: usize) -> bool {
        let place = match item {
            Item::Node(n) => &mut self.nodes[n.index()],
            Item::Fragment(f) => &mut self.fragments[f.index()],
        };
        std::mem::replace(place, at) == usize::MAX
    }

    fn of(&self, item: Item) -> usize {
        match item {
            Item::Node(n) => self.nodes[n.index()],
            Item::Fragment(f) => self.fragments[f.index()],
        }
    }
}
