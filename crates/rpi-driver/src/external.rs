//! External functions of a net, which only C can compute.

use std::collections::BTreeSet;

use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::Role;
use rpi_image::external::ExternalFunction;
use rpi_net::Node;

use crate::analysed_net::AnalysedNet;

/// Returns an error for each external function that a net calls, for a run in the core without these functions.
#[must_use]
pub fn unlinked_functions(net: &AnalysedNet) -> Vec<Diagnostic> {
    let mut reported = BTreeSet::new();
    let mut diagnostics = Vec::new();
    for node in &net.nodes {
        let Some(function) = external_function(node) else {
            continue;
        };
        if reported.insert(function.symbol.clone()) {
            diagnostics.push(unlinked(&function, node.origin.span));
        }
    }
    diagnostics
}

/// Returns the external function that a node calls; `None` if it calls none.
fn external_function(node: &Node) -> Option<ExternalFunction> {
    let Role::ExternalFunction(parameter) = node.desc().role else {
        return None;
    };
    let index = node.desc().param(parameter)?;
    ExternalFunction::from_text(node.params.get(index)?.as_str()?)
}

fn unlinked(function: &ExternalFunction, declaration: Span) -> Diagnostic {
    let (name, symbol) = (&function.name, &function.symbol);
    Diagnostic::new(
        Code::RPI9104,
        format!("external function `{name}` is not linked"),
    )
    .primary(
        declaration,
        format!("declared here: `{symbol}` in C computes it"),
    )
    .help(format!(
        "name the C source, object file or library of `{symbol}` with `--extern FILE`, or compile the program with `rpic compile --emit c`"
    ))
}
