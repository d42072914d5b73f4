//! Rings in a dependency graph: strongly connected components, and the shortest ring through each.

use crate::passes::dependencies::Graph;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;
use rustc_hash::FxHashMap;
use std::collections::VecDeque;

/// Vertices that a search for the shortest ring of a component may begin with, times the size of the component.
const PATIENCE: usize = 1_000_000;

/// Looked up only, never walked.
type Map<K, V> = FxHashMap<K, V>;

/// The components of a graph in which every vertex depends on itself.
pub(crate) struct Rings<'g> {
    graph: &'g Graph,
    /// The components, their vertices in declaration order, sorted by the first.
    pub(crate) components: Vec<Vec<NodeIndex>>,
    /// For each vertex the number of its component, if it is in one.
    component_of: Vec<Option<usize>>,
}

impl<'g> Rings<'g> {
    pub(crate) fn new(graph: &'g Graph) -> Self {
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
        }
    }

    /// The edges that lie on rings, in the order in which they were made.
    pub(crate) fn edges(&self) -> impl Iterator<Item = EdgeIndex> + '_ {
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
    pub(crate) fn shortest(&self, component: usize) -> Vec<EdgeIndex> {
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
        let mut reached: Map<NodeIndex, EdgeIndex> = Map::default();
        let mut queue = VecDeque::from([(start, 0)]);
        while let Some((v, length)) = queue.pop_front() {
            if length + 1 >= limit {
                return None;
            }
            // petgraph gives the edges made last first.
            let mut edges: Vec<_> = self.graph.edges(v).collect();
            edges.reverse();
            for edge in edges {
                let w = edge.target();
                if w == start {
                    return Some(self.path_to(v, start, &reached, edge.id()));
                }
                let inside = self.component_of[w.index()] == self.component_of[start.index()];
                if inside && !reached.contains_key(&w) {
                    reached.insert(w, edge.id());
                    queue.push_back((w, length + 1));
                }
            }
        }
        None
    }

    fn path_to(
        &self,
        end: NodeIndex,
        start: NodeIndex,
        reached: &Map<NodeIndex, EdgeIndex>,
        last: EdgeIndex,
    ) -> Vec<EdgeIndex> {
        let mut ring = vec![last];
        let mut at = end;
        while let Some(edge) = reached.get(&at).filter(|_| at != start) {
            ring.push(*edge);
            at = self
                .graph
                .edge_endpoints(*edge)
                .map_or(start, |(from, _)| from);
        }
        ring.reverse();
        ring
    }
}
