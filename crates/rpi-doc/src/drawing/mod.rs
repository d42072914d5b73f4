//! Drawings of nets and tasks: the statements of a body as boxes, data flow as lines.
//!
//! A fragment is one box of the enclosing net, because it is one vertex there. Lines that cross its border pass through
//! a port.
//!
//! | file | idea |
//! |---|---|
//! | `scene.rs` | data model of a drawing |
//! | `reads.rs` | flows read by an expression |
//! | `body_scene.rs` | from a body to a scene |
//! | `links.rs` | data flow lines through borders |
//! | `task.rs` | from a task to a scene |
//! | `layout.rs` | coordinates of boxes and lines, in the layers of `rpi-graph` |
//! | `svg.rs` | SVG output |

mod body_scene;
mod layout;
mod links;
mod reads;
mod scene;
mod svg;
mod task;

use rpi_sema::query::DefId;
use rpi_syntax::ast::{Item, ItemKind, NodeDef};

use crate::declaration::PageContext;
use scene::Drawing;

/// Maximum number of boxes of a drawing that a page shows at once. A larger drawing is collapsed until the reader opens
/// it.
const MAX_OPEN_BOXES: usize = 28;
/// Maximum number of boxes of a drawing. A larger declaration has no drawing, because it would be unreadable.
const MAX_BOXES: usize = 400;

/// Drawing of the net of one declaration, or of the steps of a task.
pub(crate) struct DeclarationDrawing {
    drawing: Drawing,
    /// True if the drawing is small enough for a page to show it at once.
    pub(crate) is_small: bool,
}

impl DeclarationDrawing {
    /// Returns the drawing as an SVG element. `id` is the prefix of all HTML ids in it, and `title` its accessible
    /// title.
    pub(crate) fn svg(&self, id: &str, title: &str) -> String {
        svg::svg(&self.drawing, id, title)
    }
}

/// Returns the drawing of a node, fragment, command or task with more than one equation or step. Returns `None` for
/// other declarations, for smaller ones and for those with too many boxes.
pub(crate) fn draw_declaration(
    shown: &PageContext<'_>,
    id: DefId,
    item: &Item,
) -> Option<DeclarationDrawing> {
    let drawing = match &item.kind {
        ItemKind::Node(node) => match &node.definition {
            NodeDef::Body(body) => body_scene::drawing(shown, id, body),
            NodeDef::Alias(_) | NodeDef::Extern => return None,
        },
        ItemKind::Fragment(fragment) => body_scene::drawing(shown, id, &fragment.body),
        ItemKind::Command(command) => body_scene::drawing(shown, id, &command.body),
        ItemKind::Task(task) => task::drawing(shown, id, task),
        _ => return None,
    };
    let (boxes, steps) = (drawing.boxes(), drawing.steps());
    (steps > 1 && boxes <= MAX_BOXES).then_some(DeclarationDrawing {
        drawing,
        is_small: boxes <= MAX_OPEN_BOXES,
    })
}
