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
//! | `flows.rs` | value and presence of flows, activation of fragments |
//! | `equations.rs` | equations of primitives |
//! | `outputs.rs` | outputs, and the results of a command |
//! | `needed.rs` | removal of unused local flows |

mod dead_flows;
mod equations;
mod flows;
mod names;
mod operators;
mod outputs;
mod value;

use crate::Column;
use crate::passes::Analysis;
use dead_flows::remove_dead_flows;
use flows::Writer;
use rpi_diag::Diagnostic;
use std::fmt::Write as _;

/// Ports of the Lustre node in order, by the keys of the net. Without outputs, all exports become outputs.
#[derive(Clone, Copy, Debug, Default)]
pub struct NodeInterface<'a> {
    /// In-ports.
    pub inputs: &'a [Column],
    /// Out-ports.
    pub outputs: &'a [Column],
}

/// Lustre program with the diagnostics of its translation.
#[derive(Clone, PartialEq, Debug)]
pub struct LustreProgram {
    /// Text of the program.
    pub text: String,
    /// Diagnostics for primitives that became unconstrained inputs.
    pub diagnostics: Vec<Diagnostic>,
}

/// Translates an analysed net for a period in nanoseconds, which determines `dt` and the ticks of times.
#[must_use]
pub fn to_lustre(
    analysis: &Analysis,
    boundary: &NodeInterface<'_>,
    period_ns: u64,
) -> LustreProgram {
    let mut writer = Writer::new(analysis, period_ns);
    for column in boundary.inputs {
        writer.input(&column.key, column.scalar);
    }
    writer.add_inputs();
    let exports = outputs::exports(&analysis.net, boundary);
    let results = outputs::results(&analysis.net, boundary);
    let keys = exports.iter().map(|export| &export.0);
    for key in keys.chain(results.iter().map(|result| &result.name)) {
        writer.reserve(key);
    }
    writer.add_core_inputs();
    writer.fragments();
    for id in analysis.net.node_ids() {
        writer.write_primitive(id);
    }
    for (key, ty, source) in exports {
        writer.output(&key, ty, source);
    }
    writer.write_results(results);
    writer.finish()
}

impl Writer<'_> {
    fn finish(mut self) -> LustreProgram {
        let others = [&self.assumptions[..], &self.properties[..]].concat();
        (self.locals, self.equations) = remove_dead_flows(self.locals, self.equations, &others);
        let mut text = String::new();
        let _ = writeln!(text, "node {} (", self.node_name);
        put_list(&mut text, &self.inputs);
        text.push_str(")\nreturns (\n");
        put_list(&mut text, &self.outputs);
        text.push_str(");\n");
        if !self.locals.is_empty() {
            text.push_str("var\n");
            for local in &self.locals {
                let _ = writeln!(text, "  {local};");
            }
        }
        text.push_str("let\n  --%MAIN;\n");
        for equation in &self.equations {
            let _ = writeln!(text, "  {equation};");
        }
        for assumption in &self.assumptions {
            let _ = writeln!(text, "  assert {assumption};");
        }
        for claim in &self.properties {
            let _ = writeln!(text, "  --%PROPERTY {claim};");
        }
        text.push_str("tel\n");
        LustreProgram {
            text,
            diagnostics: self.diagnostics,
        }
    }
}

fn put_list(text: &mut String, declarations: &[String]) {
    let lines: Vec<String> = declarations.iter().map(|d| format!("  {d}")).collect();
    text.push_str(&lines.join(";\n"));
    text.push('\n');
}
