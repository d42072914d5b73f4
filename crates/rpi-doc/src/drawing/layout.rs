//! Coordinates of boxes and lines in pixels: scenes from the inside out, boxes in columns, lines between the columns.

use std::fmt::Write as _;

use rpi_graph::{Edge, LayerConstraint, Layers, layers};

use super::scene::{Drawing, End, Link, Role, SceneId, Shape};

/// Width of a character in the title of a box, in SVG units (pixels).
const TITLE: f64 = 7.2;
/// Width of a character in the second line of a box, in SVG units (pixels).
const DETAIL: f64 = 6.7;
/// Width of a character in the label of a line, in SVG units (pixels).
const LABEL: f64 = 6.2;
/// Height of a box with one line of text, in SVG units (pixels).
const ONE_LINE_HEIGHT: f64 = 24.0;
/// Height of a box with two lines of text, in SVG units (pixels).
const TWO_LINE_HEIGHT: f64 = 40.0;
/// Space above a nested scene within the box that contains the scene, in SVG units (pixels).
pub(super) const HEAD: f64 = 42.0;
/// Space beside and below a nested scene within the box that contains the scene, in SVG units (pixels).
pub(super) const PAD: f64 = 12.0;
/// Vertical space between two boxes of a column, in SVG units (pixels).
const ROW_GAP: f64 = 14.0;
/// Minimum horizontal space between two columns of boxes, in SVG units (pixels).
const COLUMN_GAP: f64 = 40.0;
/// Height below a box for a line from the box back to itself, in SVG units (pixels).
const LOOP: f64 = 14.0;
/// Height below all boxes for each line that runs backwards, from right to left, in SVG units (pixels).
const LANE_HEIGHT: f64 = 14.0;
/// Number of passes over all columns that move boxes vertically towards the boxes with which they are connected.
const SWEEPS: usize = 10;

/// Scene (boxes of one nesting level and the lines between them) with coordinates, in SVG units (pixels).
pub(super) struct SceneLayout {
    pub(super) width: f64,
    pub(super) height: f64,
    /// Coordinates of the boxes, in the order of the shapes of the scene.
    pub(super) boxes: Vec<BoxLayout>,
    /// Coordinates of the lines, in the order of the links of the scene.
    pub(super) lines: Vec<LineLayout>,
}

/// Box with coordinates in SVG units (pixels), relative to the upper left corner of its scene.
pub(super) struct BoxLayout {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) inner: Option<SceneLayout>,
}

/// Line between two boxes, with the coordinates of its course and of its label.
#[derive(Clone, Default)]
pub(super) struct LineLayout {
    /// Course of the line as SVG path data, in SVG units (pixels).
    pub(super) path: String,
    /// Coordinates (x, y) at which the label of the line starts, in SVG units (pixels).
    pub(super) label: (f64, f64),
}

/// Computes the layout of a scene and of all nested scenes.
pub(super) fn lay_out(drawing: &Drawing, scene: SceneId) -> SceneLayout {
    let this = &drawing.scenes[scene];
    let boxes: Vec<BoxLayout> = this
        .shapes
        .iter()
        .map(|s| measured_box(drawing, s))
        .collect();
    let pins: Vec<LayerConstraint> = this.shapes.iter().map(pin).collect();
    let mut edges: Vec<Edge> = this.links.iter().map(edge).collect();
    let layers = layers(&pins, &mut edges, usize::MAX);
    let mut plan = Plan {
        links: &this.links,
        edges,
        layers,
        boxes,
        columns: Vec::new(),
        tops: Vec::new(),
    };
    plan.place_rows();
    plan.place_columns();
    plan.finish()
}

fn edge(link: &Link) -> Edge {
    Edge {
        from: link.from.shape,
        to: link.to.shape,
        back: link.delayed || link.from.shape == link.to.shape,
    }
}

fn pin(shape: &Shape) -> LayerConstraint {
    match shape.role {
        Role::Input => LayerConstraint::First,
        Role::Output => LayerConstraint::Last,
        Role::Dot if shape.title == "end" => LayerConstraint::Last,
        _ => LayerConstraint::Free,
    }
}

/// Returns a box with the size that its texts and its nested scene need. The coordinates x and y are set later.
fn measured_box(drawing: &Drawing, shape: &Shape) -> BoxLayout {
    let letters = |text: &str| text.chars().count() as f64;
    let width = (TITLE * letters(&shape.title)).max(DETAIL * letters(&shape.detail)) + 20.0;
    let height = if shape.detail.is_empty() {
        ONE_LINE_HEIGHT
    } else {
        TWO_LINE_HEIGHT
    };
    let inner = shape.inner.map(|inner| lay_out(drawing, inner));
    let (width, height) = match &inner {
        Some(inner) => (
            width.max(inner.width + 2.0 * PAD),
            HEAD + inner.height + PAD,
        ),
        None => (width, height),
    };
    BoxLayout {
        x: 0.0,
        y: 0.0,
        width,
        height,
        inner,
    }
}

impl BoxLayout {
    /// Returns the point (x, y) at which a line leaves (`leaves` is true) or enters the box, relative to the upper left
    /// corner of the box. The point is at the port if the line ends at one, else in the middle of the side.
    fn port(&self, end: End, leaves: bool) -> (f64, f64) {
        match (&self.inner, end.port) {
            (Some(inner), Some(port)) => {
                let port = &inner.boxes[port];
                let edge = if leaves { port.x + port.width } else { port.x };
                (PAD + edge, HEAD + port.y + port.height / 2.0)
            }
            (Some(_), None) => (if leaves { self.width } else { 0.0 }, HEAD / 2.0),
            (None, _) => (if leaves { self.width } else { 0.0 }, self.height / 2.0),
        }
    }
}

/// Horizontal extent of a column of boxes, in SVG units (pixels).
#[derive(Clone, Copy)]
struct Column {
    x: f64,
    width: f64,
}

struct Plan<'p> {
    links: &'p [Link],
    edges: Vec<Edge>,
    layers: Layers,
    boxes: Vec<BoxLayout>,
    columns: Vec<Column>,
    /// Upper edge of each box and of each dummy vertex (point of a line between its boxes), in SVG units from the top
    /// of the drawing.
    tops: Vec<f64>,
}

impl Plan<'_> {
    /// Returns the height of a box or of a dummy vertex, including the space for a line from the box to itself. `item`
    /// is the index of the box, or beyond the boxes that of a dummy vertex.
    fn height(&self, item: usize) -> f64 {
        let Some(this) = self.boxes.get(item) else {
            return 4.0;
        };
        let looped = self.edges.iter().any(|e| e.from == item && e.to == item);
        this.height + if looped { LOOP } else { 0.0 }
    }

    /// Returns the vertical distance from the upper edge of a box or dummy vertex to the point at which a line leaves
    /// (`leaves` is true) or enters.
    fn offset(&self, item: usize, end: End, leaves: bool) -> f64 {
        match self.boxes.get(item) {
            Some(this) => this.port(end, leaves).1,
            None => 2.0,
        }
    }

    fn place_rows(&mut self) {
        let items = self.layers.columns.iter().flatten().max();
        self.tops = vec![0.0; items.map_or(0, |max| max + 1)];
        for column in self.layers.columns.clone() {
            let wanted = vec![0.0; column.len()];
            self.resolve_overlaps(&column, &wanted);
        }
        let count = self.layers.columns.len();
        for sweep in 0..SWEEPS {
            for k in 0..count {
                let k = if sweep % 2 == 0 { k } else { count - 1 - k };
                let column = self.layers.columns[k].clone();
                let wanted: Vec<f64> = column.iter().map(|item| self.wanted(*item)).collect();
                self.resolve_overlaps(&column, &wanted);
            }
        }
        let top = self.tops.iter().copied().fold(f64::INFINITY, f64::min);
        self.tops.iter_mut().for_each(|y| *y -= top.min(f64::MAX));
    }

    /// Returns the upper edge of a box or dummy vertex at which its lines would be horizontal on average. `item` is its
    /// index.
    fn wanted(&self, item: usize) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (chain, link) in self.layers.chains.iter().zip(self.links) {
            for pair in chain.windows(2) {
                let difference =
                    self.offset(pair[0], link.from, true) - self.offset(pair[1], link.to, false);
                if pair[0] == item {
                    (sum, count) = (sum + self.tops[pair[1]] - difference, count + 1.0);
                } else if pair[1] == item {
                    (sum, count) = (sum + self.tops[pair[0]] + difference, count + 1.0);
                }
            }
        }
        if count > 0.0 {
            sum / count
        } else {
            self.tops[item]
        }
    }

    /// Moves the items (boxes and dummy vertices) of a column vertically, as close as possible to the upper edges
    /// `wanted` without overlap. The algorithm is isotonic regression by pooling adjacent violators (Ayer et al. 1955).
    fn resolve_overlaps(&mut self, column: &[usize], wanted: &[f64]) {
        let mut pools: Vec<(f64, usize)> = Vec::new();
        let mut before = 0.0;
        let mut offsets = Vec::new();
        for (item, wanted) in column.iter().zip(wanted) {
            offsets.push(before);
            let mut pool = (wanted - before, 1);
            while let Some(last) = pools.last().filter(|last| last.0 > pool.0) {
                let count = last.1 + pool.1;
                let mean = (last.0 * last.1 as f64 + pool.0 * pool.1 as f64) / count as f64;
                pool = (mean, count);
                pools.pop();
            }
            pools.push(pool);
            before += self.height(*item) + ROW_GAP;
        }
        let bases = pools
            .iter()
            .flat_map(|(base, count)| std::iter::repeat_n(*base, *count));
        for ((item, base), offset) in column.iter().zip(bases).zip(offsets) {
            self.tops[*item] = base + offset;
        }
    }

    fn place_columns(&mut self) {
        let mut x = 0.0;
        for column in &self.layers.columns {
            let boxes = column.iter().filter_map(|item| self.boxes.get(*item));
            let width = boxes.map(|b| b.width).fold(0.0, f64::max);
            self.columns.push(Column { x, width });
            let labels = self.links.iter().filter(|l| column.contains(&l.from.shape));
            let longest = labels.map(|l| l.label.chars().count()).max().unwrap_or(0);
            x += width + COLUMN_GAP.max(LABEL * longest as f64 + 24.0);
        }
        for (k, column) in self.layers.columns.iter().enumerate() {
            for item in column {
                if let Some(this) = self.boxes.get_mut(*item) {
                    (this.x, this.y) = (self.columns[k].x, self.tops[*item].round());
                }
            }
        }
    }

    fn finish(self) -> SceneLayout {
        let ends = self.tops.iter().enumerate();
        let bottom = ends
            .map(|(item, top)| top + self.height(item))
            .fold(0.0, f64::max);
        let last = self.columns.last().map_or(0.0, |c| c.x + c.width);
        let mut lanes = 0;
        let mut lines = Vec::new();
        for k in 0..self.links.len() {
            let edge = self.edges[k];
            lines.push(match (edge.back, edge.from == edge.to) {
                (false, _) => self.forwards(k),
                (true, true) => self.around(k),
                (true, false) => {
                    lanes += 1;
                    self.backwards(k, bottom + LANE_HEIGHT * f64::from(lanes), lanes)
                }
            });
        }
        SceneLayout {
            width: last + if lanes > 0 { 16.0 } else { 0.0 },
            height: bottom
                + if lanes > 0 {
                    LANE_HEIGHT * f64::from(lanes) + 6.0
                } else {
                    0.0
                },
            boxes: self.boxes,
            lines,
        }
    }

    fn point(&self, end: End, leaves: bool) -> (f64, f64) {
        let this = &self.boxes[end.shape];
        let (x, y) = this.port(end, leaves);
        (this.x + x, this.y + y)
    }

    fn column_of(&self, item: usize) -> Column {
        let holds = |column: &Vec<usize>| column.contains(&item);
        let k = self.layers.columns.iter().position(holds);
        self.columns[k.unwrap_or(0)]
    }

    fn forwards(&self, k: usize) -> LineLayout {
        let (link, chain) = (&self.links[k], &self.layers.chains[k]);
        let (start, end) = (self.point(link.from, true), self.point(link.to, false));
        let column = self.column_of(link.from.shape);
        let mut path = format!(
            "M{:.0} {:.0}H{:.0}",
            start.0,
            start.1,
            column.x + column.width
        );
        let mut at = (column.x + column.width, start.1);
        for item in &chain[1..chain.len() - 1] {
            let column = self.column_of(*item);
            let y = self.tops[*item] + 2.0;
            bend(&mut path, at, (column.x, y));
            at = (column.x + column.width, y);
            let _ = write!(path, "H{:.0}", at.0);
        }
        let column = self.column_of(link.to.shape);
        bend(&mut path, at, (column.x, end.1));
        if end.0 > column.x {
            let _ = write!(path, "H{:.0}", end.0);
        }
        LineLayout {
            path,
            label: (start.0 + 6.0, start.1 - 4.0),
        }
    }

    /// Returns the line of link `k` from a box to itself: it leaves at the right, passes below the box and enters at
    /// the left.
    fn around(&self, k: usize) -> LineLayout {
        let link = &self.links[k];
        let (start, end) = (self.point(link.from, true), self.point(link.to, false));
        let this = &self.boxes[link.from.shape];
        let lane = this.y + this.height + 7.0;
        let (right, left) = (this.x + this.width + 9.0, this.x - 10.0);
        LineLayout {
            path: format!(
                "M{:.0} {:.0}H{right:.0}V{lane:.0}H{left:.0}V{:.0}H{:.0}",
                start.0, start.1, end.1, end.0
            ),
            label: (this.x + 4.0, lane - 3.0),
        }
    }

    /// Returns the line of link `k`, which runs backwards below all boxes at the height `lane`. `number` counts the
    /// backward lines and shifts their vertical parts, so that they do not coincide.
    fn backwards(&self, k: usize, lane: f64, number: u32) -> LineLayout {
        let link = &self.links[k];
        let (start, end) = (self.point(link.from, true), self.point(link.to, false));
        let (from, to) = (
            self.column_of(link.from.shape),
            self.column_of(link.to.shape),
        );
        let shift = f64::from(number % 4) * 4.0;
        let (right, left) = (from.x + from.width + 6.0 + shift, to.x - 10.0 - shift);
        LineLayout {
            path: format!(
                "M{:.0} {:.0}H{right:.0}V{lane:.0}H{left:.0}V{:.0}H{:.0}",
                start.0, start.1, end.1, end.0
            ),
            label: (left + 8.0, lane - 3.0),
        }
    }
}

/// Appends a Bezier curve to the path data of a line. The curve is horizontal at both ends.
fn bend(path: &mut String, from: (f64, f64), to: (f64, f64)) {
    let middle = (from.0 + to.0) / 2.0;
    let _ = write!(
        path,
        "C{middle:.0} {:.0} {middle:.0} {:.0} {:.0} {:.0}",
        from.1, to.1, to.0, to.1
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(from: usize, to: usize, delayed: bool) -> Link {
        let end = |shape| End { shape, port: None };
        Link {
            from: end(from),
            to: end(to),
            delayed,
            optional: false,
            label: String::new(),
        }
    }

    fn drawn(links: &[Link], shapes: usize) -> SceneLayout {
        let mut drawing = Drawing::default();
        let root = drawing.scene(None);
        for k in 0..shapes {
            drawing.shape(root, Shape::new(Role::Equation, format!("box {k}")));
        }
        links.iter().for_each(|l| drawing.link(root, l.clone()));
        lay_out(&drawing, root)
    }

    #[test]
    fn boxes_do_not_overlap_and_lie_within() {
        let links = [
            link(0, 2, false),
            link(1, 2, false),
            link(2, 3, false),
            link(3, 1, true),
        ];
        let laid = drawn(&links, 5);
        for (k, a) in laid.boxes.iter().enumerate() {
            assert!(a.x >= 0.0 && a.x + a.width <= laid.width, "box {k}");
            assert!(a.y >= 0.0 && a.y + a.height <= laid.height, "box {k}");
            for b in &laid.boxes[k + 1..] {
                let apart = a.x + a.width <= b.x
                    || b.x + b.width <= a.x
                    || a.y + a.height <= b.y
                    || b.y + b.height <= a.y;
                assert!(apart);
            }
        }
    }

    #[test]
    fn readers_stand_right_of_what_they_read() {
        let laid = drawn(&[link(0, 1, false), link(1, 1, true)], 2);
        assert!(laid.boxes[1].x > laid.boxes[0].x + laid.boxes[0].width);
        assert_eq!(laid.lines.len(), 2);
    }
}
