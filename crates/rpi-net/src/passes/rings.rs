//! Rings in a dependency graph: strongly connected components, and the shortest ring through each.

use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;
use std::cell::RefCell;
use std::collections::VecDeque;

/// Vertices that a search for the shortest ring of a component may begin with, times the size of the component.
const PATIENCE: usize = 1_000_000;

/// The components of a graph in which every vertex depends on itself.
#[derive(Debug)]
pub struct Rings<'g, N, E> {
    graph: &'g DiGraph<N, E>,
    /// The components, their vertices in declaration order, sorted by the first.
    pub components: Vec<Vec<NodeIndex>>,
    /// For each vertex the number of its component, if it is in one.
    component_of: Vec<Option<usize>>,
    search: RefCell<Search>,
}

/// What a search has reached; kept from one to the next, as there can be one for every ring of a large net.
#[derive(Debug)]
struct Search {
    /// For each vertex the search that reached it last, and by which edge.
    reached: Vec<(usize, EdgeIndex)>,
    /// The number of the current search.
    number: usize,
    /// Where it goes on, and how many edges away from its start.
    queue: VecDeque<(NodeIndex, usize)>,
}

impl Search {
    fn new(vertices: usize) -> Search {
        Search {
            reached: vec![(0, EdgeIndex::end()); vertices],
            number: 0,
            queue: VecDeque::new(),
        }
    }

    fn begin(&mut self, start: NodeIndex) {
        self.number += 1;
        self.queue.clear();
        self.queue.push_back((start, 0));
    }

    /// The edge by which the current search has reached a vertex.
    fn edge_to(&self, v: NodeIndex) -> Option<EdgeIndex> {
        let (search, edge) = self.reached[v.index()];
        (search == self.number).then_some(edge)
    }

    fn reach(&mut self, v: NodeIndex, edge: EdgeIndex, length: usize) {
        self.reached[v.index()] = (self.number, edge);
        self.queue.push_back((v, length));
    }
}

impl<'g, N, E> Rings<'g, N, E> {
    /// The rings of a graph.
    #[must_use]
    pub fn new(graph: &'g DiGraph<N, E>) -> Self {
        let mut components = kosaraju_scc(graph);
        components.retain(|c| c.len() > 1 || graph.contains_edge(c[0], c[0]));
        components.iter_mut().for_each(|c| c.sort_unstable());
        components.sort_unstable();
        let mut component_of = vec![None; graph.node_count()];
        for (number, component) in components.iter().enumerate() {
            for v in component {
                component_of[v.index()] = Some(number);
            }
        }
        Rings {
            graph,
            components,
            component_of,
            search: RefCell::new(Search::new(graph.node_count())),
        }
    }

    /// The edges that lie on rings, in the order in which they were made.
    pub fn edges(&self) -> impl Iterator<Item = EdgeIndex> + '_ {
        let inside = |a: NodeIndex, b: NodeIndex| {
            let component = self.component_of[a.index()];
            component.is_some() && component == self.component_of[b.index()]
        };
        let edges = self.graph.edge_references();
        edges
            .filter(move |e| inside(e.source(), e.target()))
            .map(|e| e.id())
    }

    /// The edges of the shortest ring in a component, one after the other. Of equally short ones the one through the
    /// vertex declared first. In a very large component the search ends early, with the shortest that it has met.
    #[must_use]
    pub fn shortest(&self, component: usize) -> Vec<EdgeIndex> {
        let mut best: Vec<EdgeIndex> = Vec::new();
        let size = self.components[component].len();
        for start in self.components[component].iter().take(1 + PATIENCE / size) {
            let limit = if best.is_empty() {
                usize::MAX
            } else {
                best.len()
            };
            if let Some(ring) = self.ring_through(*start, limit) {
                best = ring;
            }
        }
        best
    }

    /// The shortest ring through a vertex, if it has fewer than `limit` edges: breadth first.
    fn ring_through(&self, start: NodeIndex, limit: usize) -> Option<Vec<EdgeIndex>> {
        let mut search = self.search.borrow_mut();
        search.begin(start);
        let component = self.component_of[start.index()];
        let mut edges = Vec::new();
        while let Some((v, length)) = search.queue.pop_front() {
            if length + 1 >= limit {
                return None;
            }
            // petgraph gives the edges made last first.
            edges.extend(self.graph.edges(v).map(|e| (e.target(), e.id())));
            for (w, edge) in edges.drain(..).rev() {
                if w == start {
                    return Some(self.path_to(v, start, &search, edge));
                }
                if self.component_of[w.index()] == component && search.edge_to(w).is_none() {
                    search.reach(w, edge, length + 1);
                }
            }
        }
        None
    }

    fn path_to(
        &self,
        end: NodeIndex,
        start: NodeIndex,
        search: &Search,
        last: EdgeIndex,
    ) -> Vec<EdgeIndex> {
        let mut ring = vec![last];
        let mut at = end;
        while let Some(edge) = search.edge_to(at).filter(|_| at != start) {
            ring.push(edge);
            at = self
                .graph
                .edge_endpoints(edge)
                .map_or(start, |(from, _)| from);
        }
        ring.reverse();
        ring
    }
}
