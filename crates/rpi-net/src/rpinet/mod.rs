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
//! `parent` refers to the in-ports of the enclosing fragment. The text contains no port types; they come from
//! [`rpi_prims::registry()`]. Recording times in brackets are ignored: recorded flows are selected when a net is run.
//!
//! The two parsers of the reference system differ; this one accepts the output of both. An unknown in-port is a warning
//! (the Java core ignores it, the C++ core rejects it). Unknown types, parameters and names are errors, as in both.

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

/// Parses a net with the given name from a text in `file`. Reports all errors of the text in one run. The net is `Some`
/// exactly if no diagnostic is an error.
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

/// Formats a net as text. Results, exports and budgets of commands have no text form: apply [`with_ports`] first, which
/// converts what it can.
#[must_use]
pub fn write(net: &Net) -> String {
    write::write(net, &Tree::new(net))
}

/// Counts the elements of a text, including repeated definitions, whether or not the text is a valid net.
#[must_use]
pub fn text_size(text: &str) -> Size {
    Size::of_text(&parse::parse(FileId(0), text).0)
}

fn has_errors(findings: &[Finding]) -> bool {
    findings.iter().any(|f| f.severity() == Severity::Error)
}
