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
mod links;
mod names;
mod parse;
mod parsed_text;
mod result_ports;
mod size;
mod text_names;
mod value;
mod write;

use crate::fragment_tree::FragmentTree;
use crate::net::Net;
use crate::shape::infer_shapes;
use rpi_diag::{Diagnostic, FileId, Severity};

pub use parse::MAX_DEPTH;
pub use result_ports::results_to_ports;
pub use size::NetSize;
pub use value::write as value_text;

/// Parses a text in the form `.rpinet` to a net with the given name. Reports all errors of the text in one run. The net
/// is `Some` exactly if no diagnostic is an error.
#[must_use]
pub fn parse(name: &str, file: FileId, text: &str) -> (Option<Net>, Vec<Diagnostic>) {
    let (text, mut diagnostics) = parse::parse(file, text);
    let mut net = build::build(name, &text, &mut diagnostics);
    if !has_errors(&diagnostics) {
        diagnostics.extend(infer_shapes(&mut net));
    }
    let net = Some(net).filter(|_| !has_errors(&diagnostics));
    (net, diagnostics)
}

/// Returns a net as text in the form `.rpinet`. Results, exports and budgets of commands have no text form. Apply
/// [`results_to_ports`] first, which converts those that it can.
#[must_use]
pub fn write(net: &Net) -> String {
    write::write(net, &FragmentTree::new(net))
}

/// Returns the numbers of elements in a text in the form `.rpinet`, including repeated definitions. The text need not
/// be a valid net.
#[must_use]
pub fn count_text(text: &str) -> NetSize {
    NetSize::from_text(&parse::parse(FileId(0), text).0)
}

fn has_errors(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.iter().any(|f| f.severity() == Severity::Error)
}
