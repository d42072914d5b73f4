//! Layered graph drawing: layers from left to right along the edges, and an order within each layer with few crossings.
//!
//! Sugiyama, Tagawa and Toda, "Methods for visual understanding of hierarchical system structures", 1981: layers by the
//! longest path, dummy vertices for edges over several layers, and barycentre sweeps back and forth.

/// Constraint on the layer (column) of a box in a drawing.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum LayerConstraint {
    /// The box is in the first layer, at the left.
    First,
    /// The box is in the last layer, at the right.
    Last,
    /// The edges determine the layer of the box.
    Free,
}

/// Directed edge between two boxes of a drawing, which are identified by their indices.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Edge {
    pub(super) from: usize,
    pub(super) to: usize,
    /// As input of the layering: true if the edge is ignored when layers are assigned. As output: true if the edge
    /// points backwards, from right to left.
    pub(super) back: bool,
}

/// Boxes of a drawing, assigned to layers. A vertex below the number of boxes is the index of a box; other vertices are
/// dummies through which edges over several layers pass.
#[derive(Default, Debug)]
pub(super) struct Layers {
    /// Vertices of each layer from top to bottom. The layers are the columns of the drawing, from left to right.
    pub(super) columns: Vec<Vec<usize>>,
    /// For each edge that points forwards, the vertices on its way: start box, dummy vertices, end box. Empty for an
    /// edge that points backwards.
    pub(super) chains: Vec<Vec<usize>>,
}

/// Number of passes over all layers that reorder the vertices within each layer to reduce line crossings.
const SWEEPS: usize = 12;

/// Assigns the boxes of a drawing to layers, and orders them within the layers. `pins` constrains the layer of each
/// box. An edge that would close a cycle becomes a backward edge.
pub(super) fn layers(pins: &[LayerConstraint], edges: &mut [Edge]) -> Layers {
    break_cycles(pins.len(), edges);
    let level = levels(pins, edges);
    for edge in edges.iter_mut() {
        edge.back &= level[edge.from] >= level[edge.to];
    }
    let mut columns = vec![Vec::new(); level.iter().max().map_or(0, |max| max + 1)];
    for (vertex, level) in level.iter().enumerate() {
        columns[*level].push(vertex);
    }
    let chains = chains(&level, edges, &mut columns);
    let mut layers = Layers { columns, chains };
    layers.reduce_crossings();
    layers
}

/// Makes the graph acyclic: marks as backward each edge that leads to a vertex on the current path of a depth-first
/// search. `count` is the number of vertices.
fn break_cycles(count: usize, edges: &mut [Edge]) {
    let mut state = vec![0_u8; count];
    for start in 0..count {
        visit(start, &mut state, edges);
    }
}

fn visit(vertex: usize, state: &mut [u8], edges: &mut [Edge]) {
    if state[vertex] != 0 {
        return;
    }
    state[vertex] = 1;
    for k in 0..edges.len() {
        if edges[k].from != vertex || edges[k].back {
            continue;
        }
        match state[edges[k].to] {
            1 => edges[k].back = true,
            _ => visit(edges[k].to, state, edges),
        }
    }
    state[vertex] = 2;
}

/// Returns the index of the layer of each box: to the right of all boxes whose values it reads. A free box that reads
/// no value is moved next to its first reader.
fn levels(pins: &[LayerConstraint], edges: &[Edge]) -> Vec<usize> {
    let mut level = vec![0; pins.len()];
    let forward: Vec<&Edge> = edges.iter().filter(|edge| !edge.back).collect();
    // Relaxation as in the Bellman-Ford algorithm. The graph is acyclic now, so a longest path has fewer than n edges.
    for _ in 0..pins.len() {
        for edge in &forward {
            level[edge.to] = level[edge.to].max(level[edge.from] + 1);
        }
    }
    let reads = |v: usize| forward.iter().any(|edge| edge.to == v);
    for v in (0..pins.len()).filter(|v| pins[*v] == LayerConstraint::Free && !reads(*v)) {
        let readers = forward.iter().filter(|edge| edge.from == v);
        let first = readers.map(|edge| level[edge.to]).min();
        level[v] = first.map_or(0, |first| first - 1);
    }
    let last = level.iter().max().copied().unwrap_or(0);
    for v in (0..pins.len()).filter(|v| pins[*v] == LayerConstraint::Last) {
        level[v] = last;
    }
    level
}

/// Adds a dummy vertex in each layer that an edge crosses between its two boxes. Returns the vertices on the way of
/// each edge; empty for backward edges.
fn chains(level: &[usize], edges: &[Edge], columns: &mut [Vec<usize>]) -> Vec<Vec<usize>> {
    let mut next = level.len();
    let mut chains = Vec::new();
    for edge in edges {
        let mut chain = Vec::new();
        if !edge.back {
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
        let links = self.links();
        let mut best = self.columns.clone();
        let mut fewest = crossings(&self.columns, &links);
        for sweep in 0..SWEEPS {
            let rightwards = sweep % 2 == 0;
            let count = self.columns.len();
            for k in 1..count {
                let (column, fixed) = match rightwards {
                    true => (k, k - 1),
                    false => (count - 1 - k, count - k),
                };
                let place = positions(&self.columns[fixed]);
                sort_by_neighbours(&mut self.columns[column], &links, &place, rightwards);
            }
            let crossed = crossings(&self.columns, &links);
            if crossed < fewest {
                fewest = crossed;
                best.clone_from(&self.columns);
            }
        }
        self.columns = best;
    }

    /// Returns all pairs of connected vertices in adjacent layers: (vertex in the left layer, vertex in the right
    /// layer).
    pub(super) fn links(&self) -> Vec<(usize, usize)> {
        let pairs = self.chains.iter().flat_map(|chain| chain.windows(2));
        pairs.map(|pair| (pair[0], pair[1])).collect()
    }
}

fn positions(column: &[usize]) -> std::collections::BTreeMap<usize, usize> {
    column.iter().enumerate().map(|(k, v)| (*v, k)).collect()
}

fn sort_by_neighbours(
    column: &mut [usize],
    links: &[(usize, usize)],
    place: &std::collections::BTreeMap<usize, usize>,
    rightwards: bool,
) {
    let mean = |v: usize, old: usize| -> f64 {
        let mine = links.iter().filter_map(|(from, to)| match rightwards {
            true => (*to == v).then_some(from),
            false => (*from == v).then_some(to),
        });
        let found: Vec<usize> = mine.filter_map(|other| place.get(other).copied()).collect();
        match found.len() {
            0 => old as f64,
            n => found.iter().sum::<usize>() as f64 / n as f64,
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

fn crossings(columns: &[Vec<usize>], links: &[(usize, usize)]) -> usize {
    let mut count = 0;
    for pair in columns.windows(2) {
        let (left, right) = (positions(&pair[0]), positions(&pair[1]));
        let between: Vec<(usize, usize)> = links
            .iter()
            .filter_map(|(from, to)| Some((*left.get(from)?, *right.get(to)?)))
            .collect();
        for (k, a) in between.iter().enumerate() {
            let crosses =
                |b: &&(usize, usize)| (a.0 < b.0 && a.1 > b.1) || (a.0 > b.0 && a.1 < b.1);
            count += between[k + 1..].iter().filter(crosses).count();
        }
    }
    count
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

    #[test]
    fn lines_lead_to_the_right_and_keep_places_free() {
        let mut edges = [edge(0, 1), edge(1, 2), edge(0, 2)];
        let found = layers(&[LayerConstraint::Free; 3], &mut edges);
        assert_eq!(found.columns[0], [0]);
        assert_eq!(found.columns[2], [2]);
        assert_eq!(found.chains[2], [0, 3, 2]);
    }

    #[test]
    fn a_ring_is_broken_by_one_line_backwards() {
        let mut edges = [edge(0, 1), edge(1, 0)];
        layers(&[LayerConstraint::Free; 2], &mut edges);
        assert_eq!(edges.map(|edge| edge.back), [false, true]);
    }

    #[test]
    fn crossings_are_taken_out() {
        let mut edges = [edge(0, 3), edge(1, 2)];
        let found = layers(&[LayerConstraint::Free; 4], &mut edges);
        assert_eq!(crossings(&found.columns, &found.links()), 0);
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
        let found = layers(&pins, &mut edges);
        assert!(found.columns[2].contains(&3));
    }
}
