//! Lowering: from a scheduled net to the flat image.
//!
//! ```text
//! Net + Plan --build--> Flat (registers, operations in a tree of scopes) --passes--> Flat --emit--> Image
//! ```
//! [`mod@build`] decides under which guard each operation runs. The passes optimise without changing a bit of the
//! results. [`mod@emit`] assigns memory slots. This crate does not depend on source texts or devices, and does not run
//! nets.

mod access;
mod boolean_ops;
mod build;
mod emit;
mod flat_net;
mod lower_error;
mod options;
mod passes;
mod plan;
mod registers;

pub use lower_error::LowerError;
pub use options::{LowerOptions, Observe};
pub use plan::Plan;

use flat_net::FlatNet;
use rpi_image::Image;
use rpi_net::Net;
use rpi_prims::PrimId;

/// Translates a net that has passed all checks to an image, its executable form.
///
/// # Errors
/// Returns an error if the command needs more memory than an image may have.
pub fn lower(net: &Net, plan: &Plan<'_>, options: &LowerOptions<'_>) -> Result<Image, LowerError> {
    let mut flat = build::build(net, plan, options);
    if options.observe == Observe::Exports {
        passes::run(&mut flat, options.clock(), |flat, pass| {
            if cfg!(debug_assertions) {
                verify_pass(net, flat, options, pass.name);
            }
        });
    }
    emit::emit(net, &flat, options)
}

/// Returns the names and descriptions of the optimisation passes, in the order in which they run.
pub fn passes() -> impl Iterator<Item = (&'static str, &'static str)> {
    passes::PASSES.iter().map(|p| (p.name, p.description))
}

/// Verifies the image of the net after the optimisation pass named `pass`. Panics with the text of the image if it
/// violates a rule.
fn verify_pass(net: &Net, flat: &FlatNet, options: &LowerOptions<'_>, pass: &str) {
    let catalogue = |name: &str| PrimId::from_name(name).map(PrimId::desc);
    let Ok(image) = emit::emit(net, flat, options) else {
        return;
    };
    if let Err(errors) = rpi_image::verify(&image, &catalogue) {
        let print = rpi_image::text::print(&image, &catalogue);
        panic!("after pass {pass}: {}\n{print}", errors[0]);
    }
}
