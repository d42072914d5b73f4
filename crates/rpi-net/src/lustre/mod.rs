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

mod equations;
mod flows;
mod names;
mod operators;
mod value;

use crate::Column;
use crate::net::{Driver, Input, Net, PortRef};
use crate::passes::Analysis;
use flows::Writer;
use rpi_diag::Finding;
use rpi_image::{Scalar, Type};
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

/// Writes an analysed net.
#[must_use]
pub fn write(analysis: &Analysis, boundary: &Boundary<'_>) -> Lustre {
    let mut writer = Writer::new(analysis);
    for column in boundary.inputs {
        writer.input(&column.key, column.ty);
    }
    writer.take_inputs();
    let outputs = outputs(&analysis.net, boundary);
    for (key, ..) in &outputs {
        writer.reserve(key);
    }
    writer.fragments();
    for id in analysis.net.node_ids() {
        writer.equation(id);
    }
    for (key, ty, source) in &outputs {
        writer.output(key, *ty, source);
    }
    writer.finish()
}

/// What goes out: what is asked for, else all exports, then how a command ends.
fn outputs(net: &Net, boundary: &Boundary<'_>) -> Vec<(String, Scalar, Input)> {
    let exported = |key: &str| net.exports.iter().find(|export| export.key == key);
    let port = |port: PortRef| Input::Port(port);
    let mut all = Vec::new();
    for column in boundary.outputs {
        if let Some(export) = exported(&column.key) {
            all.push((column.key.clone(), column.ty, port(export.source)));
        }
    }
    if !boundary.outputs.is_empty() {
        return all;
    }
    for export in &net.exports {
        let ty = net.node(export.source.node).outputs[usize::from(export.source.port)];
        if let Type::One(scalar) = ty {
            all.push((export.key.clone(), scalar, port(export.source)));
        }
    }
    if let Driver::Results(results) = &net.driver {
        let results = results.iter();
        all.extend(results.map(|r| (r.name.clone(), Scalar::Bool, r.condition.clone())));
    }
    all
}

impl Writer<'_> {
    fn finish(self) -> Lustre {
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
