//! Dependency cycles in a graph: strongly connected components, and the shortest cycle through each.

use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;
use std::cell::RefCell;
use std::collections::VecDeque;

/// Limit on the work of a search for the shortest cycle of a component: number of start vertices times size of the
/// component.
const SEARCH_BUDGET: usize = 1_000_000;

/// Strongly connected components of a graph that contain a cycle, so that each of their vertices depends on itself.
#[derive(Debug)]
pub struct CyclicComponents<'g, N, E> {
    graph: &'g DiGraph<N, E>,
    /// Vertices of each component in ascending order. The components are sorted by their first vertex.
    pub components: Vec<Vec<NodeIndex>>,
    /// For each vertex, the index of its component; `None` if it lies on no cycle.
    component_of: Vec<Option<usize>>,
    search: RefCell<Search>,
}

/// State of a breadth-first search. It is used again for each search, as a large net may need one search per dependency
/// cycle.
#[derive(Debug)]
struct Search {
    /// For each vertex, the number of the last search that reached it, and the edge by which it was reached.
    reached: Vec<(usize, EdgeIndex)>,
    /// Number of the current search, counted from 1.
    number: usize,
    /// Vertices to visit, each with its distance from the start in edges.
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

    /// Returns the edge by which the current search has reached a vertex; `None` if it has not.
    fn edge_to(&self, v: NodeIndex) -> Option<EdgeIndex> {
        let (search, edge) = self.reached[v.index()];
        (search == self.number).then_some(edge)
    }

    fn reach(&mut self, v: NodeIndex, edge: EdgeIndex, length: usize) {
        self.reached[v.index()] = (self.number, edge);
        self.queue.push_back((v, length));
    }
}

impl<'g, N, E> CyclicComponents<'g, N, E> {
    /// Computes the cyclic components of a graph.
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
        CyclicComponents {
            graph,
            components,
            component_of,
            search: RefCell::new(Search::new(graph.node_count())),
        }
    }

    /// Returns the edges that lie on cycles of the graph, in the order of their insertion.
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

    /// Returns the edges of the shortest cycle in the component with this index, in order. Among equally short cycles,
    /// the one through the first vertex is returned.
    ///
    /// In a very large component the search ends early with the shortest cycle found so far.
    #[must_use]
    pub fn shortest_cycle(&self, component: usize) -> Vec<EdgeIndex> {
        let mut best: Vec<EdgeIndex> = Vec::new();
        let size = self.components[component].len();
        for start in self.components[component]
            .iter()
            .take(1 + SEARCH_BUDGET / size)
        {
            let limit = if best.is_empty() {
                usize::MAX
            } else {
                best.len()
            };
            if let Some(ring) = self.shortest_cycle_through(*start, limit) {
                best = ring;
            }
        }
        best
    }

    /// Returns the edges of the shortest cycle through a vertex, found by breadth-first search; `None` if it has
    /// `limit` or more edges.
    fn shortest_cycle_through(&self, start: NodeIndex, limit: usize) -> Option<Vec<EdgeIndex>> {
        let mut search = self.search.borrow_mut();
        search.begin(start);
        let component = self.component_of[start.index()];
        let mut edges = Vec::new();
        while let Some((v, length)) = search.queue.pop_front() {
            if length + 1 >= limit {
                return None;
            }
            // petgraph iterates over edges in reverse order of insertion.
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
