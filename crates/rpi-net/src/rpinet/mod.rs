//! `.rpinet`: the text form of nets that the reference system's control cores read and write.
//!
//! ```text
//! net      = fragment
//! fragment = "{" [ entry { "," entry } ] "}"
//! entry    = name [ "[" seconds "]" ] "=" subject [ "." outPort ]    with ".outPort": an out-port of this fragment
//! subject  = name                                                    reference; alone in an entry: a second name
//!          | type "(" [ argument { "," argument } ] ")"              primitive
//!          | fragment "(" [ argument { "," argument } ] ")"          fragment with its in-ports
//! argument = name [ "[" seconds "]" ] "=" ( "'" text "'" | subject "." outPort )
//! name, type, outPort = { letter | digit | "_" | ":" }
//! ```
//! `parent` stands for the in-ports of the fragment around. Types of ports are not in the text; they come from
//! [`rpi_prims::registry()`]. Recording times in brackets are read over: what is recorded is chosen when a net is run.
//!
//! The reference's two readers differ; this one takes what either writes. An unknown in-port is a warning (its Java core
//! ignores it, its C++ core refuses it); unknown types, parameters and names are errors (as in both).

mod arguments;
mod build;
mod constants;
mod ends;
mod links;
mod names;
mod parse;
mod ports;
mod size;
mod text;
mod value;
mod write;

use crate::net::Net;
use crate::shape::infer_shapes;
use crate::tree::Tree;
use rpi_diag::{FileId, Finding, Severity};

pub use ends::with_ports;
pub use parse::MAX_DEPTH;
pub use size::Size;
pub use value::write as value_text;

/// Reads a net; `name` becomes the net's, `file` is where the text lies. All faults of the text are found in one go.
/// There is a net exactly if none of the findings is an error.
#[must_use]
pub fn read(name: &str, file: FileId, text: &str) -> (Option<Net>, Vec<Finding>) {
    let (text, mut findings) = parse::parse(file, text);
    let mut net = build::build(name, &text, &mut findings);
    if !has_errors(&findings) {
        findings.extend(infer_shapes(&mut net));
    }
    let net = Some(net).filter(|_| !has_errors(&findings));
    (net, findings)
}

/// Writes a net. Results, exports and budgets of commands have no place in the text: [`with_ports`] puts what it has words
/// for in place of them.
#[must_use]
pub fn write(net: &Net) -> String {
    write::write(net, &Tree::new(net))
}

/// Counts what stands in a text, repetitions included, whether or not it makes a net.
#[must_use]
pub fn text_size(text: &str) -> Size {
    Size::of_text(&parse::parse(FileId(0), text).0)
}

fn has_errors(findings: &[Finding]) -> bool {
    findings.iter().any(|f| f.severity() == Severity::Error)
}
