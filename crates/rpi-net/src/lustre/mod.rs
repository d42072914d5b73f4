//! Translation of a net to a Lustre program, for tools that prove properties of such programs.
//!
//! The program is one node with one equation per primitive, in the subset that Lustre V6 and Kind 2 share. Boolean
//! flows represent the state of a fragment: `NAME_on` is true while it is active, `NAME_again` while its state is
//! reset. A flow that may be absent has a companion `NAME_is`. State is a `pre` that is updated only while its fragment
//! is active. A primitive without Lustre equivalent becomes an unconstrained input and is reported.
//!
//! This module does not depend on source texts.
//!
//! | file | content |
//! |---|---|
//! | `names.rs` | valid Lustre names |
//! | `operators.rs` | table of primitives that are Lustre expressions |
//! | `value.rs` | literals |
//! | `node.rs` | text of the Lustre node |
//! | `observed_flow.rs` | value and presence of a flow as expressions |
//! | `translator.rs` | names, values and presences of the flows of a net |
//! | `activation.rs` | flows for the activation and reset of fragments, and states |
//! | `fragment_activations.rs` | expressions of these flows |
//! | `inputs.rs` | inputs of the Lustre node |
//! | `equations.rs` | equations of primitives |
//! | `operations.rs` | equations of primitives that are not strict |
//! | `stateful.rs` | equations of primitives with state |
//! | `outputs.rs` | outputs, and the results of a command |
//! | `dead_flows.rs` | removal of unused local flows |

mod activation;
mod dead_flows;
mod equations;
mod fragment_activations;
mod inputs;
mod names;
mod node;
mod observed_flow;
mod operations;
mod operators;
mod outputs;
mod stateful;
mod translator;
mod value;

use crate::Column;
use crate::passes::Analysis;
use rpi_diag::Diagnostic;
use translator::Translator;

/// Interface of the Lustre node: its ports in order, by the keys of the net. If it lists no outputs, all exports and
/// results of the net become outputs.
#[derive(Clone, Copy, Debug, Default)]
pub struct NodeInterface<'a> {
    /// Inputs of the Lustre node.
    pub inputs: &'a [Column],
    /// Outputs of the Lustre node; empty for all exports and results of the net.
    pub outputs: &'a [Column],
}

/// Translation of a net to Lustre: program text and diagnostics.
#[derive(Clone, PartialEq, Debug)]
pub struct LustreProgram {
    /// Text of the Lustre program.
    pub text: String,
    /// Warnings about primitives without Lustre equivalent, whose outputs became unconstrained inputs.
    pub diagnostics: Vec<Diagnostic>,
}

/// Translates an analysed net to a Lustre node.
///
/// `period_ns` is the period of a cycle in nanoseconds, which determines the value of `dt` and the number of ticks in a
/// duration.
#[must_use]
pub fn to_lustre(
    analysis: &Analysis,
    boundary: &NodeInterface<'_>,
    period_ns: u64,
) -> LustreProgram {
    let mut translator = Translator::new(analysis, period_ns);
    for column in boundary.inputs {
        translator.input(&column.key, column.scalar);
    }
    translator.add_inputs();
    let exports = outputs::exports(&analysis.net, boundary);
    let results = outputs::results(&analysis.net, boundary);
    let keys = exports.iter().map(|export| &export.0);
    for key in keys.chain(results.iter().map(|result| &result.name)) {
        translator.reserve(key);
    }
    translator.add_core_inputs();
    translator.fragments();
    for id in analysis.net.node_ids() {
        translator.write_primitive(id);
    }
    for (key, ty, source) in exports {
        translator.output(&key, ty, source);
    }
    translator.write_results(results);
    LustreProgram {
        text: translator.node.into_text(),
        diagnostics: translator.diagnostics,
    }
}
