//! Data model of a drawing: boxes, which may contain scenes, and lines between them.

/// Index of a scene (the boxes of one nesting level) in [`Drawing::scenes`].
pub(super) type SceneId = usize;
/// Index of a box in [`Scene::shapes`].
pub(super) type ShapeId = usize;

/// Box of a drawing, identified by the index of its scene and the index of the box in the scene.
pub(super) type BoxId = (SceneId, ShapeId);

/// All scenes of a drawing. The first one is the outermost; the others are within a box.
#[derive(Default)]
pub(super) struct Drawing {
    pub(super) scenes: Vec<Scene>,
}

/// Scene: the boxes of one nesting level, and the lines between them.
#[derive(Default)]
pub(super) struct Scene {
    /// Box that contains the scene; `None` for the outermost scene.
    pub(super) parent: Option<BoxId>,
    pub(super) shapes: Vec<Shape>,
    pub(super) links: Vec<Link>,
}

/// Kind of a box, which decides its shape and colour.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Role {
    /// Flow that enters a declaration or a box from outside, such as an in-port.
    Input,
    /// Flow of an inner block that is read outside of the block.
    Output,
    /// Equation that defines a flow of the body.
    Equation,
    /// Equation that defines an out-port or drives an actuator.
    OutputEquation,
    /// Result or exported flow of a command.
    Result,
    /// Fragment, with the boxes of its body inside.
    Fragment,
    /// Automaton, with the boxes of its states inside.
    Automaton,
    /// State of an automaton, with the boxes of its body inside.
    State,
    /// Step of a task, which runs a command.
    Step,
    /// Dot that marks the start or the end of a task.
    Dot,
}

impl Role {
    /// Returns the CSS class of a box with this role.
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
    /// First line of text in the box, emphasised.
    pub(super) title: String,
    /// Second line of text in the box; empty if there is none.
    pub(super) detail: String,
    /// Full text that a tooltip shows; empty for no tooltip.
    pub(super) tooltip: String,
    /// Address to which the title is linked, such as that of the called declaration; `None` for no link.
    pub(super) href: Option<String>,
    /// Scene inside the box; `None` if the box contains no other boxes.
    pub(super) inner: Option<SceneId>,
}

impl Shape {
    /// Creates a box whose only text is a title.
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

/// End of a line: a box, and the port at which the line passes through the border of the box. A port is a box of the
/// scene inside; `None` if the line ends at the box itself.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct End {
    pub(super) shape: ShapeId,
    pub(super) port: Option<ShapeId>,
}

/// Line of a drawing: from the box that computes a value to a box that reads it, or from a step or state to the next
/// one.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct Link {
    pub(super) from: End,
    pub(super) to: End,
    /// True if the value of an earlier cycle is read; for a transition, true if it leads to the same or an earlier
    /// state.
    pub(super) delayed: bool,
    /// True if the value may be absent in a cycle.
    pub(super) optional: bool,
    /// Text at the line, such as the condition of a transition; empty for none.
    pub(super) label: String,
}

impl Drawing {
    /// Adds an empty scene inside the box `parent`, or the outermost scene if `parent` is `None`. Returns its index.
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

    /// Adds a box to a scene and returns its identifier.
    pub(super) fn shape(&mut self, scene: SceneId, shape: Shape) -> BoxId {
        self.scenes[scene].shapes.push(shape);
        (scene, self.scenes[scene].shapes.len() - 1)
    }

    /// Adds a line to a scene, unless the scene has an equal line.
    pub(super) fn link(&mut self, scene: SceneId, link: Link) {
        let links = &mut self.scenes[scene].links;
        if !links.contains(&link) {
            links.push(link);
        }
    }

    /// Returns the number of boxes in all scenes.
    pub(super) fn boxes(&self) -> usize {
        self.scenes.iter().map(|scene| scene.shapes.len()).sum()
    }

    /// Returns the number of boxes that stand for equations, results, blocks and steps: all except inputs, outputs and
    /// dots.
    pub(super) fn steps(&self) -> usize {
        let all = self.scenes.iter().flat_map(|scene| &scene.shapes);
        all.filter(|shape| !matches!(shape.role, Role::Input | Role::Output | Role::Dot))
            .count()
    }

    /// Returns the boxes around a box from the outermost to the innermost, followed by the box itself.
    pub(super) fn enclosing(&self, place: BoxId) -> Vec<BoxId> {
        let mut all: Vec<BoxId> =
            std::iter::successors(Some(place), |(scene, _)| self.scenes[*scene].parent).collect();
        all.reverse();
        all
    }
}
