//! From a scheduled net to the flat image.
//!
//! ```text
//! Net + Plan --build--> Flat (slots, operations in a tree of scopes) --passes--> Flat --emit--> Image
//! ```
//! [`mod@build`] decides what runs under which guard, the passes make it faster without changing a bit, [`mod@emit`] gives
//! every slot its cells. Nothing here knows a source text or a device; nothing here runs a net.

mod build;
mod emit;
mod flat;
mod logic;
mod options;
mod plan;
mod slots;

pub use options::{LowerOptions, Observe};
pub use plan::Plan;

use rpi_image::Image;
use rpi_net::Net;

/// Lowers a net that has passed the checks.
///
/// # Errors
/// What makes the command too large to run, in words for its author.
pub fn lower(net: &Net, plan: &Plan, options: &LowerOptions<'_>) -> Result<Image, String> {
    let flat = build::build(net, plan, options);
    emit::emit(net, &flat, options)
}
