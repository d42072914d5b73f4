//! `--emit c`: a net as readable C99, one function `step` per cycle.
//!
//! The file holds the inputs, outputs and state of the command as structs and needs `<math.h>` only. It computes the
//! same bits as the image where the C compiler keeps IEEE 754 arithmetic (`-ffp-contract=off`), apart from `sin` and its
//! like, which differ between C libraries in the last place. Devices are the caller's: sensors are inputs, set-points
//! outputs.

mod forms;
mod names;
mod types;
mod writer;

use crate::options::{LowerOptions, Observe};
use crate::plan::Plan;
use crate::{build, passes};
use rpi_diag::{Code, Finding};
use rpi_net::Net;

/// Writes a net as C99.
///
/// # Errors
/// One finding per kind of primitive that has no form in C.
pub fn emit_c(
    net: &Net,
    plan: &Plan<'_>,
    options: &LowerOptions<'_>,
) -> Result<String, Vec<Finding>> {
    // Names come from the ports, so these must be told.
    let named = LowerOptions {
        observe: Observe::All,
        ..*options
    };
    let mut flat = build::build(net, plan, &named);
    passes::tidy(&mut flat, options.clock());
    let missing = writer::unsupported(net, &flat);
    if missing.is_empty() {
        return Ok(writer::write(net, &flat, options));
    }
    let finding = |(prim, span): (&str, rpi_diag::Span)| {
        Finding::new(Code::RPI9101, format!("`{prim}` cannot be written as C"))
            .at(span, "used here")
            .help("run the net itself, or leave this part of it out")
    };
    Err(missing.into_iter().map(finding).collect())
}
