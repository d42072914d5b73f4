//! Writer of the C file, with the statements of `step`.

use super::declarations;
use super::forms::{self, PRELUDE};
use super::literals::literal;
use super::names::indexed;
use super::operands::{Operands, Template};
use super::types::{c_type, scalar};
use super::variables::Variables;
use crate::flat_net::{FlatNet, Item, NO_NODE, Op, OpKind, ScopeId};
use crate::options::LowerOptions;
use crate::passes::traversal::ops_in_order;
use crate::registers::{Region, Register};
use rpi_diag::Span;
use rpi_image::StateSize;
use rpi_image::image::Form;
use rpi_net::{Net, NodeId};
use rpi_prims::PrimId;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Returns the names of the primitives that cannot be written as C, in alphabetical order, each with the source
/// location of its first use. All device functions count as one primitive.
pub(super) fn unsupported(net: &Net, flat: &FlatNet) -> Vec<(&'static str, Span)> {
    let mut missing = BTreeMap::new();
    for (number, _) in ops_in_order(flat) {
        let op = flat.ops[number as usize];
        let name = match op.kind {
            OpKind::Run(prim, form) => forms::form(prim.desc().name, form)
                .is_none()
                .then_some(prim.desc().name),
            OpKind::Call(..) => Some("device function"),
            OpKind::Copy | OpKind::Actuate(..) => None,
        };
        let span = match op.node {
            NO_NODE => Span::NONE,
            node => net.node(NodeId(node)).origin.span,
        };
        if let Some(name) = name {
            missing.entry(name).or_insert(span);
        }
    }
    missing.into_iter().collect()
}

/// Returns the text of the C file for a net: declarations, `reset` and `step`.
pub(super) fn write(net: &Net, flat: &FlatNet, options: &LowerOptions<'_>) -> String {
    let template = Template {
        variables: Variables::new(net, flat),
        dt: options.dt(),
        tick_ns: options.tick_ns,
    };
    let mut writer = CWriter {
        net,
        template,
        state: Vec::new(),
        body: String::new(),
    };
    writer.body(ScopeId::ROOT, 1);
    writer.latches(ScopeId::ROOT, 1);
    // Writing to a string cannot fail.
    writer.file(options).unwrap_or_default()
}

struct CWriter<'a> {
    net: &'a Net,
    template: Template<'a>,
    /// State variables of the primitives written so far, as C type and name of the struct field.
    state: Vec<(&'static str, String)>,
    body: String,
}

impl CWriter<'_> {
    fn file(&self, options: &LowerOptions<'_>) -> Result<String, std::fmt::Error> {
        let mut out = String::new();
        let (net, variables) = (&self.net.name, &self.template.variables);
        writeln!(out, "/* {net}, one step every {} ns. */", options.period_ns)?;
        out.push_str("#include <math.h>\n#include <stdbool.h>\n#include <stdint.h>\n\n");
        declarations::structs(variables, &self.state, &mut out)?;
        writeln!(out, "{PRELUDE}")?;
        declarations::reset(variables, &mut out)?;
        out.push_str("\n/* One cycle. False if an integer overflowed or was divided by zero. */\n");
        out.push_str("bool step(const Inputs *in, State *state, Outputs *out) {\n");
        out.push_str("  bool fault = false;\n");
        declarations::guarded_variables(variables, &mut out)?;
        out.push_str(&self.body);
        declarations::outputs(variables, &mut out)?;
        out.push_str("  (void)in; (void)state;\n  return !fault;\n}\n");
        Ok(out)
    }

    /// Appends the C statements of a scope, with an `if` around them unless it is always active. `depth` is the number
    /// of indentation levels.
    fn body(&mut self, id: ScopeId, depth: usize) {
        let flat = self.template.variables.flat;
        let scope = &flat.scopes[id.index()];
        let inner = self.open(id, depth);
        if let Some((unless, fragment)) = scope.reset {
            let unless = self.template.variables.bool(unless);
            self.line(inner, &format!("if (!{unless}) {{"));
            self.restart(fragment, inner + 1);
            self.line(inner, "}");
        }
        for item in &scope.items {
            match item {
                Item::Op(op) => self.op(flat.ops[*op as usize], inner, id == ScopeId::ROOT),
                Item::Scope(child) => self.body(*child, inner),
            }
        }
        if inner > depth {
            self.line(depth, "}");
        }
    }

    fn open(&mut self, id: ScopeId, depth: usize) -> usize {
        let guard = self.template.variables.flat.scopes[id.index()].guard;
        if guard == Register::TRUE {
            return depth;
        }
        let guard = self.template.variables.bool(guard);
        self.line(depth, &format!("if ({guard}) {{"));
        depth + 1
    }

    /// Appends the C statements that restore the initial state of the delays in a fragment and in the fragments inside
    /// it. `fragment` is the index of the fragment, `depth` the number of indentation levels.
    fn restart(&mut self, fragment: u32, depth: usize) {
        let inside = |mut f: u32| loop {
            if f == fragment {
                return true;
            }
            match self.net.fragments[f as usize].parent {
                Some(parent) => f = parent.0,
                None => return false,
            }
        };
        let mut lines = Vec::new();
        for slot in self.template.variables.kept() {
            let Region::State(f) = self.template.variables.flat.registers.region(slot) else {
                continue;
            };
            let mut content = Vec::new();
            self.template
                .variables
                .flat
                .registers
                .append_initial(slot, &mut content);
            for (k, bits) in (0..).zip(content).filter(|_| inside(f.0)) {
                let value = literal(bits, self.template.variables.ty(slot));
                lines.push(format!(
                    "{} = {value};",
                    self.template.variables.name(slot, k)
                ));
            }
        }
        lines.iter().for_each(|line| self.line(depth, line));
    }

    fn line(&mut self, depth: usize, text: &str) {
        let indent = 2 * depth;
        // Writing to a string cannot fail.
        let _ = writeln!(self.body, "{:indent$}{text}", "");
    }

    fn op(&mut self, op: Op, depth: usize, declares: bool) {
        let words = self.template.variables.flat.words(op).to_vec();
        match op.kind {
            OpKind::Run(prim, form) => self.run(op, prim, form, depth, declares),
            OpKind::Copy => {
                let (from, to) = (Register(words[0]), Register(words[1]));
                for k in 0..self.template.variables.flat.registers.size(to) {
                    let value =
                        self.template
                            .variables
                            .cell(from, k, self.template.variables.ty(to));
                    self.assign(depth, declares, to, k, &value);
                }
            }
            OpKind::Actuate(number, inputs) => {
                self.set_point(number, &words[..inputs as usize], depth)
            }
            OpKind::Call(..) => {}
        }
    }

    fn set_point(&mut self, number: u32, inputs: &[u32], depth: usize) {
        let name = format!("set_point_{number}");
        self.line(depth, &format!("out->{name}_present = true;"));
        let ty = self.template.variables.flat.tables.actuators[number as usize]
            .port
            .ty;
        let cells = inputs.iter().flat_map(|s| {
            let slot = Register(*s);
            (0..self.template.variables.flat.registers.size(slot)).map(move |k| (slot, k))
        });
        let cells: Vec<String> = cells
            .map(|(slot, k)| self.template.variables.cell(slot, k, scalar(ty)))
            .collect();
        for (k, value) in (0..).zip(cells) {
            let target = indexed(&name, ty.slots(), k);
            self.line(depth, &format!("out->{target} = {value};"));
        }
    }

    fn run(&mut self, op: Op, prim: PrimId, form: Form, depth: usize, declares: bool) {
        let Some(row) = forms::form(prim.desc().name, form) else {
            return;
        };
        let operands = Operands::new(self.template.variables.flat, op, prim.desc(), form);
        if !matches!(prim.desc().state, StateSize::None) {
            let name = operands.state.trim_start_matches("state->").to_owned();
            self.state.push((row.state[0], name));
        }
        if !row.before.is_empty() {
            let text = self.template.fill(row.before, &operands, 0);
            self.line(depth, &text);
        }
        let mut cell = 0;
        for (slot, present) in operands.outputs.clone() {
            for k in 0..self.template.variables.flat.registers.size(slot) {
                let text = self.template.fill(row.cell(cell), &operands, k);
                self.assign(depth, declares, slot, k, &text);
                cell += 1;
            }
            if let Some(present) = present {
                let text = self.template.fill(row.present, &operands, 0);
                self.assign(depth, declares, present, 0, &text);
            }
        }
    }

    fn assign(&mut self, depth: usize, declares: bool, slot: Register, k: u32, value: &str) {
        let name = self.template.variables.name(slot, k);
        let declares =
            declares && self.template.variables.flat.registers.region(slot) == Region::Value;
        let line = match declares {
            true => format!(
                "const {} {name} = {value};",
                c_type(self.template.variables.ty(slot))
            ),
            false => format!("{name} = {value};"),
        };
        self.line(depth, &line);
    }

    /// Appends the C assignments to the state of the delays in a scope and the scopes inside it. They come after all
    /// computations of the cycle.
    fn latches(&mut self, id: ScopeId, depth: usize) {
        let flat = self.template.variables.flat;
        let scope = &flat.scopes[id.index()];
        let before = self.body.len();
        let inner = self.open(id, depth);
        let opened = self.body.len();
        for item in &scope.items {
            if let Item::Scope(child) = item {
                self.latches(*child, inner);
            }
        }
        for (from, to) in &scope.latches {
            for k in 0..flat.registers.size(*to) {
                let value = self
                    .template
                    .variables
                    .cell(*from, k, self.template.variables.ty(*to));
                let name = self.template.variables.name(*to, k);
                self.line(inner, &format!("{name} = {value};"));
            }
        }
        if self.body.len() == opened {
            self.body.truncate(before);
        } else if inner > depth {
            self.line(depth, "}");
        }
    }
}
