//! Nets and tasks, drawn: what is written in a body as boxes, who reads whom as lines.
//!
//! A fragment is one box of the net around it, as it is one vertex there; what crosses its border goes through a port.
//!
//! | file | idea |
//! |---|---|
//! | `scene.rs` | what is drawn |
//! | `reads.rs` | what an expression reads |
//! | `flow.rs` | from a body to a scene |
//! | `links.rs` | who reads whom, through borders |
//! | `task.rs` | from a task to a scene |
//! | `layers.rs` | the order of boxes: layers from left to right, few crossings |
//! | `layout.rs` | where boxes and lines are |
//! | `svg.rs` | the picture |

mod flow;
mod layers;
mod layout;
mod links;
mod reads;
mod scene;
mod svg;
mod task;

use rpi_sema::query::DefId;
use rpi_syntax::ast::{Item, ItemKind, NodeDef};

use crate::declaration::Shown;
use scene::Drawing;

/// From so many boxes on a drawing is shown only when it is asked for.
const LARGE: usize = 28;
/// More boxes than anybody looks at.
const TOO_LARGE: usize = 400;

/// A drawing that can be shown.
pub(crate) struct Drawn {
    drawing: Drawing,
    /// Whether it can be taken in at a glance.
    pub(crate) is_small: bool,
}

impl Drawn {
    /// The picture; `id` is a prefix for names in it.
    pub(crate) fn svg(&self, id: &str, title: &str) -> String {
        svg::svg(&self.drawing, id, title)
    }
}

/// What is inside a declaration, if that is worth a picture: more than one equation.
pub(crate) fn of(shown: &Shown<'_>, id: DefId, item: &Item) -> Option<Drawn> {
    let drawing = match &item.kind {
        ItemKind::Node(node) => match &node.definition {
            NodeDef::Body(body) => flow::drawing(shown, id, body),
            NodeDef::Alias(_) | NodeDef::Extern => return None,
        },
        ItemKind::Fragment(fragment) => flow::drawing(shown, id, &fragment.body),
        ItemKind::Command(command) => flow::drawing(shown, id, &command.body),
        ItemKind::Task(task) => task::drawing(shown, id, task),
        _ => return None,
    };
    let (boxes, steps) = (drawing.boxes(), drawing.steps());
    (steps > 1 && boxes <= TOO_LARGE).then_some(Drawn {
        drawing,
        is_small: boxes <= LARGE,
    })
}
