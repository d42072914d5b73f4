//! Greedy scheduling of the operations of several clocks into runs of one clock, with few switches between clocks.
//!
//! The fragment of a clock is entered once per run, with the same activation: its state is the same in all runs. Among
//! the ready operations, those of the current clock come first. Then comes a clock in which no operation waits for
//! another clock, so that it need not be entered again. Then comes the clock that is declared first. A net whose clocks
//! can be ordered as a whole enters each clock once. Delays and `first` depend only on their clock; they are scheduled
//! with their first reader.

use crate::fragment_tree::Item;
use crate::net::{FragmentId, Net};
use crate::passes::dependencies::{Dependencies, Graph};
use petgraph::Direction::{Incoming, Outgoing};
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use rpi_image::Role;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

/// Nodes and fragments that are evaluated, in order, from the entry into a fragment to leaving it. A fragment in the
/// list is entered once more at that point.
pub(super) type ClockRun = Vec<Item>;

/// Schedules the fragment `level` and the clock fragments in it, which group the operations of one clock. Returns the
/// runs of each; `None` if there is a dependency cycle.
pub(super) fn runs(
    net: &Net,
    dependencies: &Dependencies,
    level: FragmentId,
) -> Option<Vec<(FragmentId, ClockRun)>> {
    let mut order = ClockScheduler::new(net, dependencies, level);
    order.start();
    order.run();
    (order.remaining == 0).then_some(order.runs)
}

/// Scheduling state of one clock fragment, or of the enclosing fragment.
#[derive(Default)]
struct ClockState {
    /// Vertices of nodes and fragments in the clock whose inputs have all been scheduled.
    ready: BinaryHeap<Reverse<NodeIndex>>,
    /// Number of ready vertices in this clock and the clocks inside it.
    ready_within: usize,
    /// Number of edges from outside into this clock whose source has not been scheduled.
    waiting: usize,
    /// Child clocks with ready vertices. Each has a flag for whether it still waits for sources outside; those that do
    /// not come first.
    next: BTreeSet<(bool, FragmentId)>,
}

struct ClockScheduler<'a> {
    net: &'a Net,
    graph: &'a Graph,
    level: FragmentId,
    clocks: BTreeMap<FragmentId, ClockState>,
    /// For each vertex, the number of incoming edges whose source has not been scheduled.
    waiting: Vec<usize>,
    /// For each vertex, whether it is scheduled directly before its first reader, to avoid an extra entry into its
    /// clock.
    deferred: Vec<bool>,
    /// For each vertex, whether it has been scheduled.
    done: Vec<bool>,
    /// Number of vertices that have not been scheduled.
    remaining: usize,
    /// Stack of the clocks that have been entered and not left, each with the content of its current run.
    open: Vec<(FragmentId, ClockRun)>,
    runs: Vec<(FragmentId, ClockRun)>,
}

impl<'a> ClockScheduler<'a> {
    fn new(net: &'a Net, dependencies: &'a Dependencies, level: FragmentId) -> Self {
        let graph = dependencies.graph(level);
        let count = graph.node_count();
        let mut order = ClockScheduler {
            net,
            graph,
            level,
            clocks: BTreeMap::from([(level, ClockState::default())]),
            waiting: vec![0; count],
            deferred: vec![false; count],
            done: vec![false; count],
            remaining: count,
            open: vec![(level, ClockRun::new())],
            runs: Vec::new(),
        };
        for item in graph.node_weights() {
            if let Item::Fragment(id) = item
                && dependencies.is_clock(*id)
            {
                order.clocks.insert(*id, ClockState::default());
            }
        }
        for v in graph.node_indices() {
            order.deferred[v.index()] = order.is_carried(v);
        }
        for edge in graph.edge_references() {
            order.waiting[edge.target().index()] += 1;
            for clock in order.entered(edge.source(), edge.target()) {
                order.clocks.entry(clock).or_default().waiting += 1;
            }
        }
        order
    }

    /// Returns the fragment that directly contains the node or fragment of a vertex.
    fn fragment_of(&self, v: NodeIndex) -> FragmentId {
        match self.graph[v] {
            Item::Node(id) => self.net.node(id).fragment,
            Item::Fragment(id) => self.net.fragment(id).parent.unwrap_or(self.level),
        }
    }

    /// Returns the clocks from a fragment outwards, up to but not including the fragment that is being scheduled.
    fn outwards(&self, from: FragmentId) -> impl Iterator<Item = FragmentId> + use<'a> {
        let level = self.level;
        self.net.ancestors(from).take_while(move |f| *f != level)
    }

    /// Returns the clocks that contain the vertex `to` but not the vertex `from`. They are entered to evaluate `to`
    /// after `from`.
    fn entered(&self, from: NodeIndex, to: NodeIndex) -> Vec<FragmentId> {
        let (from, to) = (self.fragment_of(from), self.fragment_of(to));
        if from == to {
            return Vec::new();
        }
        let around: BTreeSet<FragmentId> = self.outwards(from).collect();
        let clocks = self.outwards(to);
        clocks.filter(|clock| !around.contains(clock)).collect()
    }

    /// Returns whether a vertex depends on nothing but its clock and is read only by nodes in that clock. It can then
    /// be scheduled directly before its first reader.
    fn is_carried(&self, v: NodeIndex) -> bool {
        let Item::Node(id) = self.graph[v] else {
            return false;
        };
        let home = self.fragment_of(v);
        let is_plain = matches!(self.net.node(id).desc().role, Role::Delay | Role::First);
        let is_read_here =
            |w: NodeIndex| self.fragment_of(w) == home && matches!(self.graph[w], Item::Node(_));
        is_plain
            && home != self.level
            && self.graph.neighbors_directed(v, Outgoing).all(is_read_here)
    }

    fn start(&mut self) {
        // Collects the free vertices first: carried ones make further vertices ready, which must not be counted twice.
        let free = |v: &NodeIndex| self.waiting[v.index()] == 0;
        let free: Vec<NodeIndex> = self.graph.node_indices().filter(free).collect();
        for v in free {
            self.make_ready(v);
        }
    }

    fn make_ready(&mut self, v: NodeIndex) {
        if self.deferred[v.index()] {
            return self.release(v);
        }
        let home = self.fragment_of(v);
        if let Some(clock) = self.clocks.get_mut(&home) {
            clock.ready.push(Reverse(v));
        }
        self.add_ready(home, 1);
    }

    /// Adds `change` to the number of ready vertices of the clock `home` and of the clocks around it.
    fn add_ready(&mut self, home: FragmentId, change: isize) {
        let around: Vec<FragmentId> = self.outwards(home).collect();
        for clock in around {
            let known = self.clocks.entry(clock).or_default();
            known.ready_within = known.ready_within.saturating_add_signed(change);
            self.update_candidate(clock);
        }
    }

    /// Updates a clock in the list of its parent from which the next clock to enter is chosen.
    fn update_candidate(&mut self, id: FragmentId) {
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

    /// Counts a vertex as scheduled for its readers, and makes those ready that wait for no other vertex.
    fn release(&mut self, v: NodeIndex) {
        let graph = self.graph;
        for edge in graph.edges(v) {
            let to = edge.target();
            for clock in self.entered(v, to) {
                if let Some(known) = self.clocks.get_mut(&clock) {
                    known.waiting -= 1;
                }
                self.update_candidate(clock);
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
                self.add_ready(at, -1);
                self.schedule_with_deferred(v);
                self.release(v);
            } else if let Some((_, inner)) = clock.next.first().copied() {
                self.open.push((inner, ClockRun::new()));
            } else {
                self.leave();
            }
        }
    }

    /// Schedules the deferred vertices that `v` reads, then `v` itself.
    fn schedule_with_deferred(&mut self, v: NodeIndex) {
        let mut carried: Vec<NodeIndex> = self
            .graph
            .neighbors_directed(v, Incoming)
            .filter(|w| self.deferred[w.index()] && !self.done[w.index()])
            .collect();
        carried.sort_unstable();
        carried.dedup();
        for v in carried.into_iter().chain([v]) {
            self.schedule(v);
        }
    }

    fn schedule(&mut self, v: NodeIndex) {
        self.done[v.index()] = true;
        self.remaining -= 1;
        let item = self.graph[v];
        let is_activation = matches!(item, Item::Fragment(id) if self.net.fragment(id).is_clock);
        if let (false, Some((_, run))) = (is_activation, self.open.last_mut()) {
            run.push(item);
        }
    }

    /// Ends the current run of the innermost clock and returns to the enclosing one.
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
        self.schedule_deferred();
    }

    /// Schedules the deferred vertices without a reader in the same cycle, at the end of their clocks.
    fn schedule_deferred(&mut self) {
        let rest = |v: &NodeIndex| self.deferred[v.index()] && !self.done[v.index()];
        let rest: Vec<NodeIndex> = self.graph.node_indices().filter(rest).collect();
        for v in rest {
            if self.waiting[v.index()] > 0 {
                continue;
            }
            let run = self.last_run(self.fragment_of(v));
            self.runs[run].1.push(self.graph[v]);
            self.remaining -= 1;
            self.done[v.index()] = true;
        }
    }

    /// Returns the index in `runs` of the last run of a fragment. If it has none, enters the fragment at the end.
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
            self.runs.push((inner, ClockRun::new()));
            last = self.runs.len() - 1;
        }
        last
    }
}
