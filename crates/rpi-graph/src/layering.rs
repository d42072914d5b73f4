//! Layered graph drawing: layers from left to right along the edges, and an order within each layer with few crossings.
//!
//! Sugiyama, Tagawa and Toda, "Methods for visual understanding of hierarchical system structures", 1981: layers by the
//! longest path, dummy vertices for edges over several layers, and barycentre sweeps back and forth.

use std::collections::VecDeque;

use crate::crossings::crossings;

/// Constraint on the layer (column) of a box in a drawing.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum LayerConstraint {
    /// The box is in the first layer, at the left.
    First,
    /// The box is in the last layer, at the right.
    Last,
    /// The edges determine the layer of the box.
    Free,
}

/// Directed edge between two boxes of a drawing, which are identified by their indices.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Edge {
    /// Index of the box where the edge begins.
    pub from: usize,
    /// Index of the box where the edge ends.
    pub to: usize,
    /// As input of the layering: true if the edge is ignored when layers are assigned. As output: true if the edge
    /// points backwards, from right to left.
    pub back: bool,
}

/// Boxes of a drawing, assigned to layers. A vertex below the number of boxes is the index of a box; other vertices are
/// dummies through which edges over several layers pass.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Layers {
    /// Vertices of each layer from top to bottom. The layers are the columns of the drawing, from left to right.
    pub columns: Vec<Vec<usize>>,
    /// For each edge that points forwards, the vertices on its way: start box, dummy vertices, end box. Empty for an
    /// edge that points backwards, and for one that is too long to have dummies.
    pub chains: Vec<Vec<usize>>,
}

/// Number of passes over all layers that reorder the vertices within each layer to reduce line crossings.
const SWEEPS: usize = 12;

/// Assigns the boxes of a drawing to layers, and orders them within the layers. `pins` constrains the layer of each
/// box. An edge that would close a cycle becomes a backward edge. There are at most `max_dummies` dummy vertices: the longest
/// edges have none.
pub fn layers(pins: &[LayerConstraint], edges: &mut [Edge], max_dummies: usize) -> Layers {
    break_cycles(pins.len(), edges);
    let level = levels(pins, edges);
    for edge in edges.iter_mut() {
        edge.back &= level[edge.from] >= level[edge.to];
    }
    let mut columns = vec![Vec::new(); level.iter().max().map_or(0, |max| max + 1)];
    for (vertex, level) in level.iter().enumerate() {
        columns[*level].push(vertex);
    }
    let longest = longest_chain(&level, edges, max_dummies);
    let chains = chains((&level, longest), edges, &mut columns);
    let mut layers = Layers { columns, chains };
    layers.reduce_crossings();
    layers
}

/// For each vertex, the indices of the edges that begin there.
fn edges_from(count: usize, edges: &[Edge]) -> Vec<Vec<usize>> {
    let mut from = vec![Vec::new(); count];
    for (k, edge) in edges.iter().enumerate() {
        from[edge.from].push(k);
    }
    from
}

/// Progress of the search in a vertex.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Search {
    New,
    OnPath,
    Done,
}

/// Makes the graph acyclic: marks as backward each edge that leads to a vertex on the current path of a depth-first
/// search. `count` is the number of vertices. The path is a list and no recursion, because a net may have chains of any length.
fn break_cycles(count: usize, edges: &mut [Edge]) {
    let from = edges_from(count, edges);
    let mut state = vec![Search::New; count];
    let mut path: Vec<(usize, usize)> = Vec::new();
    for start in 0..count {
        if state[start] == Search::New {
            state[start] = Search::OnPath;
            path.push((start, 0));
        }
        while let Some((vertex, next)) = path.last_mut() {
            let Some(&k) = from[*vertex].get(*next) else {
                state[*vertex] = Search::Done;
                path.pop();
                continue;
            };
            *next += 1;
            let to = edges[k].to;
            match state[to] {
                Search::OnPath => edges[k].back = true,
                Search::New if !edges[k].back => {
                    state[to] = Search::OnPath;
                    path.push((to, 0));
                }
                Search::New | Search::Done => {}
            }
        }
    }
}

/// Returns the index of the layer of each box: to the right of all boxes whose values it reads. A free box that reads
/// no value is moved next to its first reader.
fn levels(pins: &[LayerConstraint], edges: &[Edge]) -> Vec<usize> {
    let mut level = vec![0; pins.len()];
    let from = edges_from(pins.len(), edges);
    let forward = |v: usize| from[v].iter().map(|k| &edges[*k]).filter(|edge| !edge.back);
    let mut unread = vec![0; pins.len()];
    let reads = edges.iter().filter(|edge| !edge.back);
    reads.for_each(|edge| unread[edge.to] += 1);
    let reads: Vec<bool> = unread.iter().map(|count| *count > 0).collect();
    // Topological order: the graph is acyclic now.
    let mut ready: VecDeque<usize> = (0..pins.len()).filter(|v| !reads[*v]).collect();
    while let Some(v) = ready.pop_front() {
        for edge in forward(v) {
            level[edge.to] = level[edge.to].max(level[v] + 1);
            unread[edge.to] -= 1;
            if unread[edge.to] == 0 {
                ready.push_back(edge.to);
            }
        }
    }
    for v in (0..pins.len()).filter(|v| pins[*v] == LayerConstraint::Free && !reads[*v]) {
        let first = forward(v).map(|edge| level[edge.to]).min();
        level[v] = first.map_or(0, |first| first - 1);
    }
    let last = level.iter().max().copied().unwrap_or(0);
    let at_end = (0..pins.len()).filter(|v| pins[*v] == LayerConstraint::Last);
    at_end.for_each(|v| level[v] = last);
    level
}

/// Returns the maximum number of layers that an edge with dummy vertices may lead over, so that there are at most `max_dummies`.
fn longest_chain(level: &[usize], edges: &[Edge], max_dummies: usize) -> usize {
    let forward = edges.iter().filter(|edge| !edge.back);
    let mut lengths: Vec<usize> = forward
        .map(|edge| level[edge.to].saturating_sub(level[edge.from]))
        .collect();
    lengths.sort_unstable();
    let mut dummies = 0;
    let first_too_long = lengths.iter().position(|length| {
        dummies += length.saturating_sub(1);
        dummies > max_dummies
    });
    // Edges of the same length are treated alike.
    first_too_long.map_or(usize::MAX, |k| lengths[k].saturating_sub(1))
}

/// Adds a dummy vertex in each layer that an edge crosses between its two boxes, if it crosses fewer than `longest`. Returns the
/// vertices on the way of each edge.
fn chains(
    (level, longest): (&[usize], usize),
    edges: &[Edge],
    columns: &mut [Vec<usize>],
) -> Vec<Vec<usize>> {
    let mut next = level.len();
    let mut chains = Vec::new();
    for edge in edges {
        let mut chain = Vec::new();
        let length = level[edge.to].saturating_sub(level[edge.from]);
        if !edge.back && length <= longest {
            chain.push(edge.from);
            for column in columns
                .iter_mut()
                .take(level[edge.to])
                .skip(level[edge.from] + 1)
            {
                column.push(next);
                chain.push(next);
                next += 1;
            }
            chain.push(edge.to);
        }
        chains.push(chain);
    }
    chains
}

impl Layers {
    /// Reduces line crossings: orders each layer by the mean position of the connected vertices in the neighbouring
    /// layer, in sweeps to the right and to the left. The order with the fewest crossings is used.
    fn reduce_crossings(&mut self) {
        let vertices = self.columns.iter().flatten().max().map_or(0, |max| max + 1);
        let links = Links::new(vertices, &self.links());
        let mut place = vec![Place::default(); vertices];
        for (k, column) in self.columns.iter().enumerate() {
            set_places(column, k, &mut place);
        }
        let mut best = self.columns.clone();
        let mut fewest = crossings(&self.columns, &links.right, &place);
        for sweep in 0..SWEEPS {
            let rightwards = sweep % 2 == 0;
            let count = self.columns.len();
            for k in 1..count {
                let (column, fixed) = match rightwards {
                    true => (k, k - 1),
                    false => (count - 1 - k, count - k),
                };
                let neighbours = if rightwards {
                    &links.left
                } else {
                    &links.right
                };
                sort_by_neighbours(&mut self.columns[column], neighbours, fixed, &place);
                set_places(&self.columns[column], column, &mut place);
            }
            let crossed = crossings(&self.columns, &links.right, &place);
            if crossed < fewest {
                fewest = crossed;
                best.clone_from(&self.columns);
            }
        }
        self.columns = best;
    }

    /// Returns all pairs of connected vertices in adjacent layers: (vertex in the left layer, vertex in the right
    /// layer).
    pub fn links(&self) -> Vec<(usize, usize)> {
        let pairs = self.chains.iter().flat_map(|chain| chain.windows(2));
        pairs.map(|pair| (pair[0], pair[1])).collect()
    }
}

/// Place of a vertex in a drawing: its layer, and its position there.
#[derive(Clone, Copy, Default)]
pub(crate) struct Place {
    pub(crate) layer: usize,
    pub(crate) position: usize,
}

/// For each vertex, its neighbours in the layer to the left and in that to the right.
struct Links {
    left: Vec<Vec<usize>>,
    right: Vec<Vec<usize>>,
}

impl Links {
    fn new(vertices: usize, links: &[(usize, usize)]) -> Links {
        let mut all = Links {
            left: vec![Vec::new(); vertices],
            right: vec![Vec::new(); vertices],
        };
        for (from, to) in links {
            all.right[*from].push(*to);
            all.left[*to].push(*from);
        }
        all
    }
}

fn set_places(column: &[usize], layer: usize, place: &mut [Place]) {
    for (position, vertex) in column.iter().enumerate() {
        place[*vertex] = Place { layer, position };
    }
}

/// Orders a layer by the mean positions of the neighbours in the layer `fixed`.
fn sort_by_neighbours(
    column: &mut [usize],
    neighbours: &[Vec<usize>],
    fixed: usize,
    place: &[Place],
) {
    let mean = |v: usize, old: usize| -> f64 {
        let found = neighbours[v].iter().map(|other| place[*other]);
        let found = found.filter(|place| place.layer == fixed);
        let (sum, count) = found.fold((0, 0), |(sum, n), place| (sum + place.position, n + 1));
        match count {
            0 => old as f64,
            n => sum as f64 / f64::from(n),
        }
    };
    let mut keyed: Vec<(f64, usize)> = column
        .iter()
        .enumerate()
        .map(|(old, v)| (mean(*v, old), *v))
        .collect();
    keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (slot, (_, v)) in column.iter_mut().zip(keyed) {
        *slot = v;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edge(from: usize, to: usize) -> Edge {
        Edge {
            from,
            to,
            back: false,
        }
    }

    fn free(count: usize, edges: &mut [Edge]) -> Layers {
        layers(&vec![LayerConstraint::Free; count], edges, usize::MAX)
    }

    #[test]
    fn lines_lead_to_the_right_and_keep_places_free() {
        let mut edges = [edge(0, 1), edge(1, 2), edge(0, 2)];
        let found = free(3, &mut edges);
        assert_eq!(found.columns[0], [0]);
        assert_eq!(found.columns[2], [2]);
        assert_eq!(found.chains[2], [0, 3, 2]);
    }

    #[test]
    fn a_ring_is_broken_by_one_line_backwards() {
        let mut edges = [edge(0, 1), edge(1, 0)];
        free(2, &mut edges);
        assert_eq!(edges.map(|edge| edge.back), [false, true]);
    }

    #[test]
    fn crossings_are_taken_out() {
        let mut edges = [edge(0, 3), edge(1, 2)];
        let found = free(4, &mut edges);
        let at = |v: usize| {
            found
                .columns
                .iter()
                .find_map(|c| c.iter().position(|x| *x == v))
        };
        assert_eq!(at(0) < at(1), at(3) < at(2), "{found:?}");
    }

    #[test]
    fn pins_hold() {
        let mut edges = [edge(0, 1), edge(1, 2)];
        let pins = [
            LayerConstraint::First,
            LayerConstraint::Free,
            LayerConstraint::Free,
            LayerConstraint::Last,
        ];
        let found = layers(&pins, &mut edges, usize::MAX);
        assert!(found.columns[2].contains(&3));
    }

    #[test]
    fn the_longest_lines_have_no_dummies_if_there_would_be_too_many() {
        let mut edges: Vec<Edge> = (0..9).map(|k| edge(k, k + 1)).collect();
        edges.extend([edge(0, 9), edge(3, 5)]);
        let found = layers(&[LayerConstraint::Free; 10], &mut edges, 5);
        assert_eq!((found.chains[9].len(), found.chains[10].len()), (0, 3));
        assert_eq!(found.columns.iter().flatten().count(), 11);
    }

    /// A chain of this length would exceed the stack of a recursive search.
    #[test]
    fn large_nets_are_layered_in_moderate_time() {
        let count = 20_000;
        let mut edges: Vec<Edge> = (1..count).map(|k| edge(k - 1, k)).collect();
        edges.extend((50..count).map(|k| edge(k - 50, k)));
        let pins = vec![LayerConstraint::Free; count];
        let found = layers(&pins, &mut edges, 2 * count);
        assert_eq!(found.columns.len(), count);
        assert!(found.columns.iter().flatten().count() <= 3 * count);
    }
}
