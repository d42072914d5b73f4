//! `--emit c`: a net as readable C99, with one function `step` per cycle.
//!
//! The file declares the inputs, outputs and state of the command as structs and needs only `<math.h>`. It computes the
//! same bits as the image if the C compiler keeps IEEE 754 arithmetic (`-ffp-contract=off`), except for functions such
//! as `sin` that differ between C libraries in the last place. The caller handles the devices: sensors are inputs,
//! set-points outputs.

mod declarations;
mod forms;
mod literals;
mod names;
mod operands;
mod types;
mod variables;
mod writer;

use crate::options::{LowerOptions, Observe};
use crate::plan::Plan;
use crate::{build, passes};
use rpi_diag::{Code, Diagnostic};
use rpi_net::Net;

/// Translates a net to the text of a C99 file with a function `step` that computes one cycle.
///
/// # Errors
/// Returns one diagnostic for each kind of primitive that cannot be written as C.
pub fn emit_c(
    net: &Net,
    plan: &Plan<'_>,
    options: &LowerOptions<'_>,
) -> Result<String, Vec<Diagnostic>> {
    // Variable names are derived from ports, so all ports must be observable.
    let named = LowerOptions {
        observe: Observe::All,
        ..*options
    };
    let mut flat = build::build(net, plan, &named);
    passes::run_readable(&mut flat, options.clock());
    let missing = writer::unsupported(net, &flat);
    if missing.is_empty() {
        return Ok(writer::write(net, &flat, options));
    }
    let diagnostic = |(prim, span): (&str, rpi_diag::Span)| {
        Diagnostic::new(Code::RPI9101, format!("`{prim}` cannot be written as C"))
            .primary(span, "there is no C code for this primitive")
            .help("run the net with `rpi run`, which supports every primitive, or leave this primitive out")
    };
    Err(missing.into_iter().map(diagnostic).collect())
}
