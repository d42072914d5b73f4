//! Text of a Lustre node: declarations, equations, assumptions and properties.

use super::dead_flows::remove_dead_flows;
use super::names::Names;
use std::fmt::Write;

/// Lustre node that is being written: its declarations, equations and claims as text.
pub(super) struct LustreNode {
    pub(super) names: Names,
    name: String,
    inputs: Vec<String>,
    outputs: Vec<String>,
    locals: Vec<String>,
    equations: Vec<String>,
    /// Boolean expressions that a model checker may assume (`assert`).
    pub(super) assumptions: Vec<String>,
    /// Boolean expressions that a model checker must prove (`--%PROPERTY`).
    pub(super) properties: Vec<String>,
}

impl LustreNode {
    /// Creates an empty node whose name is that of the net, made valid in Lustre.
    pub(super) fn new(net_name: &str) -> Self {
        let mut names = Names::default();
        let name = names.fresh(net_name);
        LustreNode {
            names,
            name,
            inputs: Vec::new(),
            outputs: Vec::new(),
            locals: Vec::new(),
            equations: Vec::new(),
            assumptions: Vec::new(),
            properties: Vec::new(),
        }
    }

    pub(super) fn add_input(&mut self, name: &str, ty: &str) {
        self.inputs.push(format!("{name}: {ty}"));
    }

    pub(super) fn add_output(&mut self, name: &str, ty: &str) {
        self.outputs.push(format!("{name}: {ty}"));
    }

    pub(super) fn add_equation(&mut self, name: &str, value: &str) {
        self.equations.push(format!("{name} = {value}"));
    }

    /// Adds a local flow with the name `name`, the type `ty` and the expression `value`.
    pub(super) fn define(&mut self, name: &str, ty: &str, value: &str) {
        self.locals.push(format!("{name}: {ty}"));
        self.add_equation(name, value);
    }

    /// Adds a local flow with a new name similar to `like` and the expression `value`. Returns the name.
    pub(super) fn add_local(&mut self, like: &str, ty: &str, value: &str) -> String {
        let name = self.names.fresh(like);
        self.define(&name, ty, value);
        name
    }

    /// Declares a local flow with a new name similar to `like`, and returns the name. The caller must add its equation.
    pub(super) fn declare_local(&mut self, like: &str, ty: &str) -> String {
        let name = self.names.fresh(like);
        self.locals.push(format!("{name}: {ty}"));
        name
    }

    /// Removes local flows that are not used, and returns the text of the node.
    pub(super) fn into_text(mut self) -> String {
        let others = [&self.assumptions[..], &self.properties[..]].concat();
        (self.locals, self.equations) = remove_dead_flows(self.locals, self.equations, &others);
        let mut text = String::new();
        let _ = writeln!(text, "node {} (", self.name);
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
        text
    }
}

fn put_list(text: &mut String, declarations: &[String]) {
    let lines: Vec<String> = declarations.iter().map(|d| format!("  {d}")).collect();
    text.push_str(&lines.join(";\n"));
    text.push('\n');
}
