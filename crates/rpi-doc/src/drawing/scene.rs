//! What is drawn: boxes, some with scenes inside, and lines between them.

/// A scene within a drawing.
pub(super) type SceneId = usize;
/// A box within its scene.
pub(super) type ShapeId = usize;

/// A box in its scene.
pub(super) type Place = (SceneId, ShapeId);

/// All scenes of a picture; the first is the outermost.
#[derive(Default)]
pub(super) struct Drawing {
    pub(super) scenes: Vec<Scene>,
}

/// Boxes beside each other, and lines between them.
#[derive(Default)]
pub(super) struct Scene {
    /// The box that it is inside of.
    pub(super) parent: Option<Place>,
    pub(super) shapes: Vec<Shape>,
    pub(super) links: Vec<Link>,
}

/// What a box stands for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Role {
    /// A flow that comes from outside.
    Input,
    /// A flow that is read outside.
    Output,
    /// An equation.
    Equation,
    /// An equation that defines an out-port or actuator.
    Defined,
    /// A result of a command, an export.
    Result,
    /// A fragment in place.
    Fragment,
    /// An automaton.
    Automaton,
    /// A state of an automaton.
    State,
    /// A step of a task.
    Step,
    /// Where a task or an automaton begins or ends.
    Dot,
}

impl Role {
    /// The role in the words of a style sheet.
    pub(super) fn class(self) -> &'static str {
        match self {
            Role::Input => "input",
            Role::Output => "output",
            Role::Equation => "equation",
            Role::Defined => "defined",
            Role::Result => "result",
            Role::Fragment => "fragment",
            Role::Automaton => "automaton",
            Role::State => "state",
            Role::Step => "step",
            Role::Dot => "dot",
        }
    }
}

/// A box.
pub(super) struct Shape {
    pub(super) role: Role,
    /// First line, set off.
    pub(super) title: String,
    /// Second line.
    pub(super) detail: String,
    /// All of it, for a reader who asks.
    pub(super) tooltip: String,
    /// Where more is told about it.
    pub(super) href: Option<String>,
    /// What is inside.
    pub(super) inner: Option<SceneId>,
}

impl Shape {
    /// A box with one line.
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

/// Where a line ends: at a box, and for one with a scene inside at a port of it, which is a box of that scene.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct End {
    pub(super) shape: ShapeId,
    pub(super) port: Option<ShapeId>,
}

/// A line.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct Link {
    pub(super) from: End,
    pub(super) to: End,
    /// Read one cycle late.
    pub(super) delayed: bool,
    /// What is read may be absent.
    pub(super) optional: bool,
    /// What stands at the line.
    pub(super) label: String,
}

impl Drawing {
    /// Adds a scene inside a box, or the outermost one.
    pub(super) fn scene(&mut self, parent: Option<Place>) -> SceneId {
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

    /// Adds a box.
    pub(super) fn shape(&mut self, scene: SceneId, shape: Shape) -> Place {
        self.scenes[scene].shapes.push(shape);
        (scene, self.scenes[scene].shapes.len() - 1)
    }

    /// Adds a line, once.
    pub(super) fn link(&mut self, scene: SceneId, link: Link) {
        let links = &mut self.scenes[scene].links;
        if !links.contains(&link) {
            links.push(link);
        }
    }

    /// How many boxes there are.
    pub(super) fn boxes(&self) -> usize {
        self.scenes.iter().map(|scene| scene.shapes.len()).sum()
    }

    /// How many boxes are more than a way in or out.
    pub(super) fn steps(&self) -> usize {
        let all = self.scenes.iter().flat_map(|scene| &scene.shapes);
        all.filter(|shape| !matches!(shape.role, Role::Input | Role::Output | Role::Dot))
            .count()
    }

    /// The boxes around a box, outermost first, and the box itself.
    pub(super) fn around(&self, place: Place) -> Vec<Place> {
        let mut all: Vec<Place> =
            std::iter::successors(Some(place), |(scene, _)| self.scenes[*scene].parent).collect();
        all.reverse();
        all
    }
}
