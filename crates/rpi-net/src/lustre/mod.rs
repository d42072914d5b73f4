//! A net as a Lustre program, for tools that prove properties of such programs.
//!
//! One node, one equation per primitive, in the subset that Lustre V6 and Kind 2 share. What a fragment does is said by
//! Boolean flows: `NAME_on` where it is active, `NAME_again` where its state starts afresh; a flow that may be absent
//! has a companion `NAME_is`. State is a `pre` that goes on only where its fragment is active. What has no form in
//! Lustre becomes an input, about which nothing is known, and is told.
//!
//! This must not know source texts.
//!
//! | file | idea |
//! |---|---|
//! | `names.rs` | names that Lustre can have |
//! | `operators.rs` | the table of primitives that are expressions |
//! | `value.rs` | literals |
//! | `flows.rs` | what a reader sees of a flow, and when fragments are active |
//! | `equations.rs` | one primitive at a time |
//! | `outputs.rs` | what goes out, and how a command ends |
//! | `needed.rs` | what of all that is read |

mod equations;
mod flows;
mod names;
mod needed;
mod operators;
mod outputs;
mod value;

use crate::Column;
use crate::passes::Analysis;
use flows::Writer;
use needed::needed;
use rpi_diag::Finding;
use std::fmt::Write as _;

/// The ports that the node shall have, in this order, by the keys of the net; all exports if there are none.
#[derive(Clone, Copy, Debug, Default)]
pub struct Boundary<'a> {
    /// In-ports.
    pub inputs: &'a [Column],
    /// Out-ports.
    pub outputs: &'a [Column],
}

/// The text, and what it does not hold.
#[derive(Clone, PartialEq, Debug)]
pub struct Lustre {
    /// The program.
    pub text: String,
    /// What became an input.
    pub findings: Vec<Finding>,
}

/// Writes an analysed net for a period in nanoseconds, on which `dt` and the ticks of times depend.
#[must_use]
pub fn write(analysis: &Analysis, boundary: &Boundary<'_>, period_ns: u64) -> Lustre {
    let mut writer = Writer::new(analysis, period_ns);
    for column in boundary.inputs {
        writer.input(&column.key, column.ty);
    }
    writer.take_inputs();
    let exports = outputs::exports(&analysis.net, boundary);
    let results = outputs::results(&analysis.net, boundary);
    let keys = exports.iter().map(|export| &export.0);
    for key in keys.chain(results.iter().map(|result| &result.name)) {
        writer.reserve(key);
    }
    writer.take_core_flows();
    writer.fragments();
    for id in analysis.net.node_ids() {
        writer.equation(id);
    }
    for (key, ty, source) in exports {
        writer.output(&key, ty, source);
    }
    writer.choose(results);
    writer.finish()
}

impl Writer<'_> {
    fn finish(mut self) -> Lustre {
        let others = [&self.assumptions[..], &self.claims[..]].concat();
        (self.locals, self.equations) = needed(self.locals, self.equations, &others);
        let mut text = String::new();
        let _ = writeln!(text, "node {} (", self.title);
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
        for claim in &self.claims {
            let _ = writeln!(text, "  --%PROPERTY {claim};");
        }
        text.push_str("tel\n");
        Lustre {
            text,
            findings: self.findings,
        }
    }
}

fn put_list(text: &mut String, declarations: &[String]) {
    let lines: Vec<String> = declarations.iter().map(|d| format!("  {d}")).collect();
    text.push_str(&lines.join(";\n"));
    text.push('\n');
}
