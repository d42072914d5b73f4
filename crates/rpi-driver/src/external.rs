//! External functions of a net, which only C can compute.

use std::collections::BTreeSet;

use rpi_diag::{Code, Diagnostic};
use rpi_image::Role;
use rpi_image::external::ExternalFunction;

use crate::analysed_net::AnalysedNet;

/// Returns an error for each external function that a net calls, for a run in the core without these functions.
#[must_use]
pub fn unlinked_functions(net: &AnalysedNet) -> Vec<Diagnostic> {
    let mut reported = BTreeSet::new();
    let mut diagnostics = Vec::new();
    for node in &net.nodes {
        let Role::ExternalFunction(parameter) = node.desc().role else {
            continue;
        };
        let index = node.desc().param(parameter);
        let text = index.and_then(|k| node.params.get(k)?.as_str());
        let Some(function) = text.and_then(ExternalFunction::from_text) else {
            continue;
        };
        if !reported.insert(function.symbol.clone()) {
            continue;
        }
        let message = format!("external function `{}` is not linked", function.name);
        let symbol = function.symbol;
        diagnostics.push(
            Diagnostic::new(Code::RPI9104, message)
                .primary(
                    node.origin.span,
                    format!("declared here: `{symbol}` in C computes it"),
                )
                .help(format!(
                    "name the C source, object file or library of `{symbol}` with `--extern FILE`, or compile the program with `rpic compile --emit c`"
                )),
        );
    }
    diagnostics
}
