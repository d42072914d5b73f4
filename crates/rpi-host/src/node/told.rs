//! Diagnostics for faults in a cycle of a node.

use rpi_diag::{Code, FileId, Finding, Span};
use rpi_image::Image;
use rpi_prims::Fault;

/// Returns the diagnostic for a fault, with its source location and cycle number. `of` names the faulty command if the
/// message must name it.
pub(crate) fn fault(image: &Image, fault: Fault, cycle: u64, of: Option<&str>) -> Finding {
    let what = crate::run::fault_text(fault.code);
    let of = of.map_or_else(String::new, |of| format!(" of `{of}`"));
    let place = image.place_of(fault.cell);
    let span = place.and_then(|place| place.text).map(|text| Span {
        file: FileId(text.file),
        start: text.start,
        end: text.end,
    });
    let flow = place.and_then(|place| place.flow.clone().or_else(|| Some(place.path.clone())));
    // The suffix after `#` numbers the parts of an expression. It is not part of the flow's name.
    let label = flow.map_or_else(String::new, |flow| {
        let name = flow.split('#').next().unwrap_or(&flow);
        format!("for `{name}`")
    });
    Finding::new(Code::RPI9011, format!("cycle {cycle}{of}: {what}"))
        .at(span.unwrap_or(Span::NONE), label)
}
