//! Conversion of a model to text.

use std::fmt::Write as _;

use super::model::{
    Body, Bound, Declared, Equation, Expr, Flow, FlowId, Model, Node, State, Statement, Unit,
};

/// Declarations used by all programs.
const PRELUDE: &str = "type Pair = struct { u: int; v: int };\n\
    type Mode = enum { Off, Slow, Fast };\n\
    node Count (x: int) returns (n: int);\nlet n = (0 -> pre n) mod 100 + x; tel\n\
    node Split (c: bool; x: int) returns (a: int when c; b: int);\nlet a = x when c; b = 0 -> pre x; tel\n";

impl Model {
    pub(crate) fn text(&self) -> String {
        let mut out = PRELUDE.to_owned();
        if !self.lustre {
            out = out.replace(");\nlet", ")\nlet");
        }
        for unit in &self.units {
            self.unit(unit, &mut out);
        }
        out
    }

    fn unit(&self, unit: &Unit, out: &mut String) {
        let ports = |flows: &[FlowId]| {
            let ports = flows.iter().map(|flow| port(&self.flows[*flow]));
            ports.collect::<Vec<_>>().join("; ")
        };
        let end = if self.lustre { ";" } else { "" };
        let (inputs, outputs) = (ports(&unit.inputs), ports(&unit.outputs));
        let _ = writeln!(
            out,
            "node {} ({inputs}) returns ({outputs}){end}",
            unit.name
        );
        self.body(&unit.body, "", out);
        out.push('\n');
    }

    fn body(&self, body: &Body, indent: &str, out: &mut String) {
        let declared = body.locals.iter().map(|flow| &self.flows[*flow]);
        let declared = declared.filter(|flow| flow.declared != Declared::Not);
        let declared: Vec<String> = declared.map(|flow| format!(" {};", port(flow))).collect();
        if !declared.is_empty() {
            let _ = writeln!(out, "{indent}var{}", declared.concat());
        }
        let _ = writeln!(out, "{indent}let");
        for statement in &body.statements {
            self.statement(statement, &format!("{indent}  "), out);
        }
        let _ = write!(out, "{indent}tel");
    }

    fn statement(&self, statement: &Statement, indent: &str, out: &mut String) {
        match statement {
            Statement::Equation(equation) => {
                let (names, value) = (self.bound(equation), self.expr(&equation.value));
                let _ = writeln!(out, "{indent}{names} = {value};");
            }
            Statement::Fragment {
                name,
                when,
                restart,
                body,
            } => {
                let restart = if *restart { " restart" } else { "" };
                let when = self.expr(when);
                let _ = writeln!(out, "{indent}fragment {name} when {when}{restart}");
                self.body(body, indent, out);
                out.push('\n');
            }
            Statement::Automaton(states) => {
                let _ = writeln!(out, "{indent}automaton");
                for (k, state) in states.iter().enumerate() {
                    self.state(state, k == 0, &format!("{indent}  "), out);
                }
                let _ = writeln!(out, "{indent}end");
            }
        }
    }

    fn state(&self, state: &State, initial: bool, indent: &str, out: &mut String) {
        let initial = if initial { "initial " } else { "" };
        let _ = writeln!(out, "{indent}{initial}state {}", state.name);
        for (condition, how, target) in &state.unless {
            let condition = self.expr(condition);
            let _ = writeln!(out, "{indent}  unless {condition} {how} {target};");
        }
        self.body(&state.body, indent, out);
        out.push('\n');
        for (condition, how, target) in &state.until {
            let condition = self.expr(condition);
            let _ = writeln!(out, "{indent}  until {condition} {how} {target};");
        }
    }

    fn bound(&self, equation: &Equation) -> String {
        let names = equation
            .targets
            .iter()
            .map(|flow| self.flows[*flow].name.as_str());
        let names: Vec<&str> = names.collect();
        match &equation.bound {
            Bound::Whole(name) => name.clone(),
            Bound::Names if names.len() == 1 => names[0].to_owned(),
            Bound::Names => format!("({})", names.join(", ")),
        }
    }

    pub(crate) fn expr(&self, expr: &Expr) -> String {
        match &expr.node {
            Node::Flow(flow) => self.flows[*flow].name.clone(),
            Node::Template(text, parts) => {
                let mut out = String::new();
                let mut parts = parts.iter();
                for (k, piece) in text.split('@').enumerate() {
                    if k > 0 {
                        out.extend(parts.next().map(|part| self.expr(part)));
                    }
                    out.push_str(piece);
                }
                out
            }
        }
    }
}

/// Returns the declaration of a flow.
fn port(flow: &Flow) -> String {
    let (name, kind) = (&flow.name, flow.kind.text());
    match (flow.declared, flow.clock.last()) {
        (Declared::Optional, _) => format!("{name}: {kind}?"),
        // A flow that may be absent at ticks of its clock.
        (_, Some(_)) if flow.optional => format!("{name}: {kind}?"),
        (_, Some(on)) => format!("{name}: {kind} when {on}"),
        (_, None) if flow.optional => format!("{name}: {kind}?"),
        (_, None) => format!("{name}: {kind}"),
    }
}
