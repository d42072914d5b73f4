//! The net of a command as boxes and lines. Boxes contain scenes, which a reader can open and close.

use crate::layering::{Edge, LayerConstraint, Layers, layers};

/// Number of dummy vertices of a scene in addition to two for each box.
const DUMMIES: usize = 500;

/// Net of a command: scenes, of which the first is the outermost and each of the others is inside one box.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct NetGraph {
    /// Name of the command.
    pub command: String,
    /// Scenes; those inside of a box come after the scene of the box.
    pub scenes: Vec<Scene>,
}

/// The boxes of one nesting level, and the lines between them.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Scene {
    /// Boxes in the order of the program.
    pub boxes: Vec<GraphBox>,
    /// Lines between the boxes, each once.
    pub lines: Vec<Line>,
    /// Layers of the boxes, with a chain for each line.
    pub layers: Layers,
}

/// Kind of a box.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum BoxKind {
    /// Flow with the expression that defines it.
    Flow,
    /// Call of a node, or flows whose names begin alike; the flows are inside.
    Call,
    /// Fragment or state of an automaton.
    Fragment,
    /// Port of a device that the command reads.
    Sensor,
    /// Port of a device that the command drives.
    Actuator,
    /// Result with which the command ends.
    Result,
    /// Condition of a fragment.
    Condition,
    /// Port at the left border of a scene: a flow from outside.
    In,
    /// Port at the right border of a scene: a flow that is read outside.
    Out,
}

impl BoxKind {
    /// Returns the name of the kind for a reader of the graph.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            BoxKind::Flow => "flow",
            BoxKind::Call => "call",
            BoxKind::Fragment => "fragment",
            BoxKind::Sensor => "sensor",
            BoxKind::Actuator => "actuator",
            BoxKind::Result => "result",
            BoxKind::Condition => "condition",
            BoxKind::In => "in",
            BoxKind::Out => "out",
        }
    }

    fn constraint(self) -> LayerConstraint {
        match self {
            BoxKind::In => LayerConstraint::First,
            BoxKind::Out => LayerConstraint::Last,
            _ => LayerConstraint::Free,
        }
    }
}

/// Box of a scene.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct GraphBox {
    /// Text in the box.
    pub name: String,
    /// Kind of the box.
    pub kind: BoxKind,
    /// Name of its flow, with the fragments and calls around it and without the command; `None` if the box has no flow of its own.
    pub flow: Option<String>,
    /// Further flows with values of the box: other names of its flow, and further outputs of a call.
    pub other_flows: Vec<String>,
    /// Path of its fragment as images have it, such as `outer/inner`; `None` if the box is no fragment.
    pub fragment: Option<String>,
    /// Place in the program.
    pub place: Option<Place>,
    /// Index of the scene inside.
    pub inner: Option<usize>,
}

/// Place in a text.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Place {
    /// Name of the file.
    pub file: String,
    /// Number of the line, counted from 1.
    pub line: u32,
}

/// Line between two boxes of a scene.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Line {
    /// Where the value comes from.
    pub from: End,
    /// Where it is read.
    pub to: End,
    /// Whether the value of an earlier cycle is read.
    pub is_delayed: bool,
    /// Whether the value decides whether a fragment is active or is reset.
    pub is_condition: bool,
}

/// End of a line: a box, and the port of the scene inside through which the line passes.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct End {
    /// Index of the box in the scene.
    pub shape: usize,
    /// Index of the port among the boxes of the scene inside; `None` if the line ends at the box.
    pub port: Option<usize>,
}

impl Scene {
    /// Assigns the boxes to layers, and orders the layers.
    pub fn lay_out(&mut self) {
        let pins: Vec<LayerConstraint> = self.boxes.iter().map(|b| b.kind.constraint()).collect();
        let edges = self.lines.iter().map(|line| Edge {
            from: line.from.shape,
            to: line.to.shape,
            back: line.is_delayed || line.from.shape == line.to.shape,
        });
        let mut edges: Vec<Edge> = edges.collect();
        self.layers = layers(&pins, &mut edges, 2 * pins.len() + DUMMIES);
    }
}
