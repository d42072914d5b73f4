//! Data model of a drawing: boxes, which may contain scenes, and lines between them.

/// Index of a scene in a drawing.
pub(super) type SceneId = usize;
/// Index of a box in its scene.
pub(super) type ShapeId = usize;

/// Box, identified by its scene and its index there.
pub(super) type BoxId = (SceneId, ShapeId);

/// All scenes of a drawing; the first is the outermost.
#[derive(Default)]
pub(super) struct Drawing {
    pub(super) scenes: Vec<Scene>,
}

/// Boxes on one level, and the lines between them.
#[derive(Default)]
pub(super) struct Scene {
    /// Box that contains the scene.
    pub(super) parent: Option<BoxId>,
    pub(super) shapes: Vec<Shape>,
    pub(super) links: Vec<Link>,
}

/// Kind of a box, which decides its shape and colour.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Role {
    /// Flow that enters the declaration, such as an in-port.
    Input,
    /// Flow of an inner block that is read outside of it.
    Output,
    /// Box of an equation that is not a call.
    Equation,
    /// Equation that defines an out-port or actuator.
    OutputEquation,
    /// Result or export of a command.
    Result,
    /// Box of a fragment, which contains the boxes of its body.
    Fragment,
    /// Box of an automaton with its states.
    Automaton,
    /// State of an automaton.
    State,
    /// Step of a task.
    Step,
    /// Dot that marks the start or the end of a task.
    Dot,
}

impl Role {
    /// Returns the CSS class of the role.
    pub(super) fn class(self) -> &'static str {
        match self {
            Role::Input => "input",
            Role::Output => "output",
            Role::Equation => "equation",
            Role::OutputEquation => "defined",
            Role::Result => "result",
            Role::Fragment => "fragment",
            Role::Automaton => "automaton",
            Role::State => "state",
            Role::Step => "step",
            Role::Dot => "dot",
        }
    }
}

/// Box of a drawing, before the layout gives it coordinates.
pub(super) struct Shape {
    pub(super) role: Role,
    /// First line of text, emphasised.
    pub(super) title: String,
    /// Second line of text.
    pub(super) detail: String,
    /// Full text, shown as a tooltip.
    pub(super) tooltip: String,
    /// Link to further documentation.
    pub(super) href: Option<String>,
    /// Scene drawn inside the box, if it contains other boxes.
    pub(super) inner: Option<SceneId>,
}

impl Shape {
    /// Creates a box with one line of text.
    pub(super) fn new(role: Role, title: impl Into<String>) -> Shape {
        Shape {
            role,
            title: title.into(),
            detail: String::new(),
            tooltip: String::new(),
            href: None,
            inner: None,
        }
    }
}

/// End of a line: a box, and if the box has a nested scene, a port, which is a box of that scene.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct End {
    pub(super) shape: ShapeId,
    pub(super) port: Option<ShapeId>,
}

/// Line from the box that computes a value to a box that reads it.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct Link {
    pub(super) from: End,
    pub(super) to: End,
    /// Whether the value of the previous cycle is read.
    pub(super) delayed: bool,
    /// Whether the value may be absent.
    pub(super) optional: bool,
    /// Text at the line.
    pub(super) label: String,
}

impl Drawing {
    /// Adds a scene inside a box, or the outermost one.
    pub(super) fn scene(&mut self, parent: Option<BoxId>) -> SceneId {
        let id = self.scenes.len();
        self.scenes.push(Scene {
            parent,
            ..Scene::default()
        });
        if let Some((scene, shape)) = parent {
            self.scenes[scene].shapes[shape].inner = Some(id);
        }
        id
    }

    /// Adds a box and returns its identifier.
    pub(super) fn shape(&mut self, scene: SceneId, shape: Shape) -> BoxId {
        self.scenes[scene].shapes.push(shape);
        (scene, self.scenes[scene].shapes.len() - 1)
    }

    /// Adds a line unless an equal one exists.
    pub(super) fn link(&mut self, scene: SceneId, link: Link) {
        let links = &mut self.scenes[scene].links;
        if !links.contains(&link) {
            links.push(link);
        }
    }

    /// Returns the number of boxes.
    pub(super) fn boxes(&self) -> usize {
        self.scenes.iter().map(|scene| scene.shapes.len()).sum()
    }

    /// Returns the number of boxes that are not inputs, outputs or dots.
    pub(super) fn steps(&self) -> usize {
        let all = self.scenes.iter().flat_map(|scene| &scene.shapes);
        all.filter(|shape| !matches!(shape.role, Role::Input | Role::Output | Role::Dot))
            .count()
    }

    /// Returns the enclosing boxes of a box, outermost first, followed by the box itself.
    pub(super) fn enclosing(&self, place: BoxId) -> Vec<BoxId> {
        let mut all: Vec<BoxId> =
            std::iter::successors(Some(place), |(scene, _)| self.scenes[*scene].parent).collect();
        all.reverse();
        all
    }
}
