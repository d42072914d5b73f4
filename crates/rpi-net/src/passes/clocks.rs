//! The order in which single operations of several clocks run: in runs of one clock, as few as a greedy choice makes them.
//!
//! The fragment of a clock is entered once for each run, with the same activation: state in it is the same whichever run
//! reads or keeps it. Of all that is ready, what belongs to the clock that is entered goes first; then a clock of which
//! nothing waits for anything outside, so that it is left for good; then the one declared first. So a net in which the
//! clocks can be ordered as wholes enters each once. Delays and `first` wait for nothing but their clock: they go with
//! whoever reads them first.

use crate::net::{FragmentId, Net};
use crate::passes::dependencies::{Dependencies, Graph};
use crate::tree::Item;
use petgraph::Direction::{Incoming, Outgoing};
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use rpi_image::Role;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

/// What runs in a fragment between entering and leaving it, in order. A fragment in it is entered there once more.
pub(super) type Run = Vec<Item>;

/// The runs of a fragment and of the fragments of clocks in it; none if something depends on itself.
pub(super) fn runs(
    net: &Net,
    dependencies: &Dependencies,
    level: FragmentId,
) -> Option<Vec<(FragmentId, Run)>> {
    let mut order = Order::new(net, dependencies, level);
    order.start();
    order.run();
    (order.left == 0).then_some(order.runs)
}

/// A clock, or the level itself.
#[derive(Default)]
struct Clock {
    /// Operations that wait for nothing.
    ready: BinaryHeap<Reverse<NodeIndex>>,
    /// How many there are here and in the clocks within.
    ready_within: usize,
    /// How much in it waits for something outside.
    waiting: usize,
    /// The clocks directly in it of which something is ready: those that wait for nothing outside come first.
    next: BTreeSet<(bool, FragmentId)>,
}

struct Order<'a> {
    net: &'a Net,
    graph: &'a Graph,
    level: FragmentId,
    clocks: BTreeMap<FragmentId, Clock>,
    /// For each vertex what it waits for.
    waiting: Vec<usize>,
    /// Vertices that go with their first reader.
    carried: Vec<bool>,
    /// Vertices that have run.
    done: Vec<bool>,
    /// How many have not.
    left: usize,
    /// The clocks that are entered, each in the one before, with what has run in them.
    open: Vec<(FragmentId, Run)>,
    runs: Vec<(FragmentId, Run)>,
}

impl<'a> Order<'a> {
    fn new(net: &'a Net, dependencies: &'a Dependencies, level: FragmentId) -> Self {
        let graph = dependencies.graph(level);
        let count = graph.node_count();
        let mut order = Order {
            net,
            graph,
            level,
            clocks: BTreeMap::from([(level, Clock::default())]),
            waiting: vec![0; count],
            carried: vec![false; count],
            done: vec![false; count],
            left: count,
            open: vec![(level, Run::new())],
            runs: Vec::new(),
        };
        for item in graph.node_weights() {
            if let Item::Fragment(id) = item
                && dependencies.is_clock(*id)
            {
                order.clocks.insert(*id, Clock::default());
            }
        }
        for v in graph.node_indices() {
            order.carried[v.index()] = order.is_carried(v);
        }
        for edge in graph.edge_references() {
            order.waiting[edge.target().index()] += 1;
            for clock in order.entered(edge.source(), edge.target()) {
                order.clocks.entry(clock).or_default().waiting += 1;
            }
        }
        order
    }

    /// The fragment in which a vertex stands.
    fn home(&self, v: NodeIndex) -> FragmentId {
        match self.graph[v] {
            Item::Node(id) => self.net.node(id).fragment,
            Item::Fragment(id) => self.net.fragment(id).parent.unwrap_or(self.level),
        }
    }

    /// The clocks from a fragment outwards, without the level.
    fn outwards(&self, from: FragmentId) -> impl Iterator<Item = FragmentId> + use<'a> {
        let level = self.level;
        self.net.enclosing(from).take_while(move |f| *f != level)
    }

    /// The clocks that one has to enter on the way from one vertex to another.
    fn entered(&self, from: NodeIndex, to: NodeIndex) -> Vec<FragmentId> {
        let (from, to) = (self.home(from), self.home(to));
        if from == to {
            return Vec::new();
        }
        let around: BTreeSet<FragmentId> = self.outwards(from).collect();
        let clocks = self.outwards(to);
        clocks.filter(|clock| !around.contains(clock)).collect()
    }

    /// Whether a vertex waits for its clock alone and is read by that clock alone.
    fn is_carried(&self, v: NodeIndex) -> bool {
        let Item::Node(id) = self.graph[v] else {
            return false;
        };
        let home = self.home(v);
        let is_plain = matches!(self.net.node(id).desc().role, Role::Delay | Role::First);
        let is_read_here =
            |w: NodeIndex| self.home(w) == home && matches!(self.graph[w], Item::Node(_));
        is_plain
            && home != self.level
            && self.graph.neighbors_directed(v, Outgoing).all(is_read_here)
    }

    fn start(&mut self) {
        // What is carried makes others ready on the way, which must not be taken for ready from the start.
        let free = |v: &NodeIndex| self.waiting[v.index()] == 0;
        let free: Vec<NodeIndex> = self.graph.node_indices().filter(free).collect();
        for v in free {
            self.make_ready(v);
        }
    }

    fn make_ready(&mut self, v: NodeIndex) {
        if self.carried[v.index()] {
            return self.release(v);
        }
        let home = self.home(v);
        if let Some(clock) = self.clocks.get_mut(&home) {
            clock.ready.push(Reverse(v));
        }
        self.count(home, 1);
    }

    /// So many more, or one less, are ready in a clock.
    fn count(&mut self, home: FragmentId, change: isize) {
        let around: Vec<FragmentId> = self.outwards(home).collect();
        for clock in around {
            let known = self.clocks.entry(clock).or_default();
            known.ready_within = known.ready_within.saturating_add_signed(change);
            self.choose(clock);
        }
    }

    /// Enters a clock into the choice of the one around it, or takes it out.
    fn choose(&mut self, id: FragmentId) {
        let Some(clock) = self.clocks.get(&id) else {
            return;
        };
        let (waits, is_ready) = (clock.waiting > 0, clock.ready_within > 0);
        let parent = self.net.fragment(id).parent.unwrap_or(self.level);
        let next = &mut self.clocks.entry(parent).or_default().next;
        next.remove(&(!waits, id));
        match is_ready {
            true => _ = next.insert((waits, id)),
            false => _ = next.remove(&(waits, id)),
        }
    }

    /// Whoever waits for a vertex waits for one less.
    fn release(&mut self, v: NodeIndex) {
        let graph = self.graph;
        for edge in graph.edges(v) {
            let to = edge.target();
            for clock in self.entered(v, to) {
                if let Some(known) = self.clocks.get_mut(&clock) {
                    known.waiting -= 1;
                }
                self.choose(clock);
            }
            self.waiting[to.index()] -= 1;
            if self.waiting[to.index()] == 0 {
                self.make_ready(to);
            }
        }
    }

    fn run(&mut self) {
        while let Some((at, _)) = self.open.last() {
            let at = *at;
            let Some(clock) = self.clocks.get_mut(&at) else {
                return;
            };
            if let Some(Reverse(v)) = clock.ready.pop() {
                self.count(at, -1);
                self.take(v);
                self.release(v);
            } else if let Some((_, inner)) = clock.next.first().copied() {
                self.open.push((inner, Run::new()));
            } else {
                self.leave();
            }
        }
    }

    /// Runs a vertex, behind what is carried to it.
    fn take(&mut self, v: NodeIndex) {
        let mut carried: Vec<NodeIndex> = self
            .graph
            .neighbors_directed(v, Incoming)
            .filter(|w| self.carried[w.index()] && !self.done[w.index()])
            .collect();
        carried.sort_unstable();
        carried.dedup();
        for v in carried.into_iter().chain([v]) {
            self.put(v);
        }
    }

    fn put(&mut self, v: NodeIndex) {
        self.done[v.index()] = true;
        self.left -= 1;
        let item = self.graph[v];
        let is_activation = matches!(item, Item::Fragment(id) if self.net.fragment(id).is_clock);
        if let (false, Some((_, run))) = (is_activation, self.open.last_mut()) {
            run.push(item);
        }
    }

    /// Leaves the clock that is entered.
    fn leave(&mut self) {
        let Some((at, run)) = self.open.pop() else {
            return;
        };
        if let Some((_, around)) = self.open.last_mut() {
            around.push(Item::Fragment(at));
            self.runs.push((at, run));
            return;
        }
        self.runs.push((at, run));
        self.put_rest();
    }

    /// What nobody reads within the cycle runs last in its clock.
    fn put_rest(&mut self) {
        let rest = |v: &NodeIndex| self.carried[v.index()] && !self.done[v.index()];
        let rest: Vec<NodeIndex> = self.graph.node_indices().filter(rest).collect();
        for v in rest {
            if self.waiting[v.index()] > 0 {
                continue;
            }
            let run = self.last_run(self.home(v));
            self.runs[run].1.push(self.graph[v]);
            self.left -= 1;
            self.done[v.index()] = true;
        }
    }

    /// The last run of a fragment; it is entered at the end if it has none.
    fn last_run(&mut self, fragment: FragmentId) -> usize {
        let mut path = Vec::new();
        let mut at = fragment;
        let mut last = loop {
            match self.runs.iter().rposition(|(of, _)| *of == at) {
                Some(known) => break known,
                None => path.push(at),
            }
            at = self.net.fragment(at).parent.unwrap_or(self.level);
        };
        for inner in path.into_iter().rev() {
            self.runs[last].1.push(Item::Fragment(inner));
            self.runs.push((inner, Run::new()));
            last = self.runs.len() - 1;
        }
        last
    }
}
