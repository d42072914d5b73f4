//! Lines of a graph: each data flow as a line in the innermost scene around both ends, and through ports in the scenes further inside.

use std::collections::{BTreeMap, BTreeSet};

use rpi_graph::{BoxKind, End, GraphBox, Line, NetGraph};
use rpi_net::FragmentId;

use super::boxes::{BoxId, BoxTree, new_box};

/// Meaning of a line.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum LineKind {
    /// The value of this cycle is read.
    Value,
    /// The value of an earlier cycle is read.
    Delayed,
    /// The value decides whether a fragment is active or is reset.
    Condition,
}

/// Builder of the lines between boxes.
pub(super) struct Lines {
    tree: BoxTree,
    /// Lines by scene.
    lines: Vec<BTreeSet<Line>>,
    /// Ports by scene, kind and the box from which the flow comes.
    ports: BTreeMap<(usize, BoxKind, BoxId), usize>,
}

impl Lines {
    pub(super) fn new(tree: BoxTree) -> Lines {
        Lines {
            lines: vec![BTreeSet::new(); tree.scenes.len()],
            ports: BTreeMap::new(),
            tree,
        }
    }

    /// Returns the box of a fragment; `None` for one without a name.
    pub(super) fn fragment_box(&self, fragment: FragmentId) -> Option<BoxId> {
        self.tree.fragments.get(&fragment.0).copied()
    }

    /// Returns the boxes around a box from the outermost to the innermost, then the box itself.
    fn enclosing(&self, place: BoxId) -> Vec<BoxId> {
        let around = std::iter::successors(Some(place), |(scene, _)| self.tree.around[*scene]);
        let mut all: Vec<BoxId> = around.collect();
        all.reverse();
        all
    }

    /// Adds a line from a box to a box of any scene. A line from a box to the expression of the same box is only shown if it is delayed.
    pub(super) fn add(&mut self, from: BoxId, to: BoxId, kind: LineKind) {
        let (left, right) = (self.enclosing(from), self.enclosing(to));
        let mut pairs = left.iter().zip(&right);
        let common = pairs.position(|(a, b)| a != b);
        let Some(at) = common else {
            // One box is inside the other one, or they are the same.
            if from == to && kind == LineKind::Delayed {
                self.insert(from.0, plain(from.1), plain(from.1), kind);
            }
            return;
        };
        let start = self.out_port(&left[at..], kind);
        let end = self.in_port(&right[at..], from, kind);
        self.insert(left[at].0, start, end, kind);
    }

    /// Leads a flow from the last of these boxes out of those around it. Returns the end of its line in the scene of the first one.
    fn out_port(&mut self, path: &[BoxId], kind: LineKind) -> End {
        let source = path[path.len() - 1];
        let mut end = plain(source.1);
        for around in path[..path.len() - 1].iter().rev() {
            let scene = self.tree.scenes[around.0].boxes[around.1].inner;
            let scene = scene.unwrap_or_default();
            let port = self.port(scene, BoxKind::Out, source);
            self.insert(scene, end, plain(port), kind);
            end = End {
                shape: around.1,
                port: Some(port),
            };
        }
        end
    }

    /// Leads a flow of the box `source` to the last of these boxes, through the borders of those around it.
    fn in_port(&mut self, path: &[BoxId], source: BoxId, kind: LineKind) -> End {
        let mut end = plain(path[path.len() - 1].1);
        for around in path[..path.len() - 1].iter().rev() {
            let scene = self.tree.scenes[around.0].boxes[around.1].inner;
            let scene = scene.unwrap_or_default();
            let port = self.port(scene, BoxKind::In, source);
            self.insert(scene, plain(port), end, kind);
            end = End {
                shape: around.1,
                port: Some(port),
            };
        }
        end
    }

    /// Returns the port of a scene for a flow, which is added if there is none.
    fn port(&mut self, scene: usize, kind: BoxKind, source: BoxId) -> usize {
        let shown = &self.tree.scenes[source.0].boxes[source.1];
        let made = GraphBox {
            flow: shown.flow.clone(),
            place: shown.place.clone(),
            ..new_box(&shown.name, kind)
        };
        let boxes = &mut self.tree.scenes[scene].boxes;
        *self.ports.entry((scene, kind, source)).or_insert_with(|| {
            boxes.push(made);
            boxes.len() - 1
        })
    }

    fn insert(&mut self, scene: usize, from: End, to: End, kind: LineKind) {
        self.lines[scene].insert(Line {
            from,
            to,
            is_delayed: kind == LineKind::Delayed,
            is_condition: kind == LineKind::Condition,
        });
    }

    /// Returns the graph, with the layers of each scene.
    pub(super) fn finish(self, command: &str) -> NetGraph {
        let mut scenes = self.tree.scenes;
        for (scene, lines) in scenes.iter_mut().zip(self.lines) {
            scene.lines = lines.into_iter().collect();
            scene.lay_out();
        }
        NetGraph {
            command: command.to_owned(),
            scenes,
        }
    }
}

fn plain(shape: usize) -> End {
    End { shape, port: None }
}
