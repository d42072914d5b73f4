//! Writer of the C file: structs, `reset`, `step`.

use super::forms::{self, CForm, PRELUDE};
use super::names::{VariableNames, identifier};
use super::types::{c_type, expected, scalar, types};
use crate::flat_net::{FlatNet, Item, NO_NODE, Op, OpKind, ScopeId};
use crate::options::LowerOptions;
use crate::passes::traversal::ops_in_order;
use crate::registers::{Region, Register};
use rpi_diag::Span;
use rpi_image::image::{CommandEnd, Form, Signal};
use rpi_image::operands::{OperandRole, operand_layout};
use rpi_image::{PrimDesc, Scalar, StateSize};
use rpi_net::{Net, NodeId};
use rpi_prims::PrimId;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Operations without a C form, each with the first place of its use.
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

/// Writes the C file.
pub(super) fn write(net: &Net, flat: &FlatNet, options: &LowerOptions<'_>) -> String {
    let mut writer = CWriter {
        net,
        flat,
        names: VariableNames::new(net, flat),
        types: types(flat),
        dt: options.dt(),
        tick_ns: options.tick_ns,
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
    flat: &'a FlatNet,
    names: VariableNames,
    types: Vec<Scalar>,
    dt: f64,
    tick_ns: u64,
    /// State of primitives: C type and name.
    state: Vec<(&'static str, String)>,
    body: String,
}

impl CWriter<'_> {
    fn file(&self, options: &LowerOptions<'_>) -> Result<String, std::fmt::Error> {
        let mut out = String::new();
        let net = &self.net.name;
        writeln!(out, "/* {net}, one step every {} ns. */", options.period_ns)?;
        out.push_str("#include <math.h>\n#include <stdbool.h>\n#include <stdint.h>\n\n");
        self.structs(&mut out)?;
        writeln!(out, "{PRELUDE}")?;
        self.reset(&mut out)?;
        out.push_str("\n/* One cycle. False if an integer overflowed or was divided by zero. */\n");
        out.push_str("bool step(const Inputs *in, State *state, Outputs *out) {\n");
        out.push_str("  bool fault = false;\n");
        self.guarded_variables(&mut out)?;
        out.push_str(&self.body);
        self.outputs(&mut out)?;
        out.push_str("  (void)in; (void)state;\n  return !fault;\n}\n");
        Ok(out)
    }

    fn structs(&self, out: &mut String) -> std::fmt::Result {
        out.push_str("typedef struct {\n");
        let mut any = false;
        for signal in self.external() {
            any = true;
            self.members(out, Register(signal.start), scalar(signal.ty))?;
            if self.flat.registers.region(Register(signal.present)) != Region::Constant {
                self.members(out, Register(signal.present), Scalar::Bool)?;
            }
        }
        out.push_str(if any {
            "} Inputs;\n\n"
        } else {
            "  char none;\n} Inputs;\n\n"
        });
        out.push_str("typedef struct {\n");
        for (name, ty, cells) in self.published() {
            for k in 0..cells.max(1) {
                writeln!(out, "  {ty} {};", indexed(&name, cells, k))?;
            }
        }
        out.push_str("  bool ends;\n} Outputs;\n\ntypedef struct {\n");
        for slot in self.kept() {
            for k in 0..self.flat.registers.size(slot) {
                let name = self.names.cell(self.flat, slot, k);
                let ty = c_type(self.types[slot.index()]);
                writeln!(out, "  {ty} {};", name.trim_start_matches("state->"))?;
            }
        }
        for (ty, name) in &self.state {
            writeln!(out, "  {ty} {name};")?;
        }
        out.push_str("  char none;\n} State;\n\n");
        Ok(())
    }

    fn members(&self, out: &mut String, slot: Register, ty: Scalar) -> std::fmt::Result {
        for k in 0..self.flat.registers.size(slot) {
            let name = self.names.cell(self.flat, slot, k);
            writeln!(out, "  {} {};", c_type(ty), name.trim_start_matches("in->"))?;
        }
        Ok(())
    }

    /// Signals that are set from outside: sensors, inputs, flows of the core.
    fn external(&self) -> Vec<Signal> {
        let t = &self.flat.tables;
        let inputs = t
            .inputs
            .iter()
            .flat_map(|i| std::iter::once(i.value).chain(i.last_updated));
        let sensors = t.sensors.iter().map(|s| s.0.value);
        sensors
            .chain(inputs)
            .chain(t.flows.iter().map(|f| f.value))
            .collect()
    }

    /// Outputs: exports and set-points, each preceded by its presence. Each entry has a name, a C type and a number of
    /// slots.
    fn published(&self) -> Vec<(String, &'static str, u32)> {
        let mut all = Vec::new();
        for export in &self.flat.tables.exports {
            let name = identifier(&export.key);
            all.push((format!("{name}_present"), "bool", 1));
            all.push((
                name,
                c_type(scalar(export.value.ty)),
                export.value.ty.slots(),
            ));
        }
        for (k, actuator) in self.flat.tables.actuators.iter().enumerate() {
            let name = format!("set_point_{k}");
            all.push((format!("{name}_present"), "bool", 1));
            all.push((
                name,
                c_type(scalar(actuator.port.ty)),
                actuator.port.ty.slots(),
            ));
        }
        all
    }

    /// State registers of delays, in order.
    fn kept(&self) -> Vec<Register> {
        let latched = self
            .flat
            .scopes
            .iter()
            .flat_map(|s| s.latches.iter().map(|l| l.1));
        let mut kept: Vec<Register> = latched.collect();
        kept.sort_unstable();
        kept.dedup();
        kept
    }

    fn reset(&self, out: &mut String) -> std::fmt::Result {
        out.push_str("/* The state before the first cycle. */\nvoid reset(State *state) {\n  *state = (State){0};\n");
        for slot in self.kept() {
            let mut content = Vec::new();
            self.flat.registers.append_initial(slot, &mut content);
            for (k, bits) in (0..).zip(content).filter(|c| c.1 != 0) {
                let value = literal(bits, self.types[slot.index()]);
                writeln!(out, "  {} = {value};", self.names.cell(self.flat, slot, k))?;
            }
        }
        out.push_str("}\n");
        Ok(())
    }

    /// Declares the variables that are assigned inside an `if`.
    fn guarded_variables(&self, out: &mut String) -> std::fmt::Result {
        for (number, scope) in ops_in_order(self.flat) {
            if scope == ScopeId::ROOT {
                continue;
            }
            for slot in self.flat.writes(self.flat.ops[number as usize]) {
                for k in 0..self.flat.registers.size(slot) {
                    let ty = c_type(self.types[slot.index()]);
                    writeln!(out, "  {ty} {} = 0;", self.names.cell(self.flat, slot, k))?;
                }
            }
        }
        for k in 0..self.flat.tables.actuators.len() {
            writeln!(out, "  out->set_point_{k}_present = false;")?;
        }
        Ok(())
    }

    fn outputs(&self, out: &mut String) -> std::fmt::Result {
        for export in &self.flat.tables.exports {
            let (name, s) = (identifier(&export.key), export.value);
            let present = self.bool(Register(s.present));
            writeln!(out, "  out->{name}_present = {present};")?;
            for k in 0..s.ty.slots() {
                let value = self.cell(Register(s.start), k, scalar(s.ty));
                writeln!(out, "  out->{} = {value};", indexed(&name, s.ty.slots(), k))?;
            }
        }
        let ends: Vec<Signal> = match &self.flat.tables.end {
            CommandEnd::Results(results) => results.iter().map(|r| r.condition).collect(),
            CommandEnd::Ports { terminate, .. } => terminate.iter().copied().collect(),
        };
        let asks = ends.iter().map(|s| {
            format!(
                "({} && {})",
                self.bool(Register(s.present)),
                self.bool(Register(s.start))
            )
        });
        let asks: Vec<String> = std::iter::once("false".to_owned()).chain(asks).collect();
        writeln!(out, "  out->ends = {};", asks.join(" || "))
    }

    /// Writes the statements of a scope.
    fn body(&mut self, id: ScopeId, depth: usize) {
        let flat = self.flat;
        let scope = &flat.scopes[id.index()];
        let inner = self.open(id, depth);
        if let Some((unless, fragment)) = scope.reset {
            let unless = self.bool(unless);
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
        let guard = self.flat.scopes[id.index()].guard;
        if guard == Register::TRUE {
            return depth;
        }
        let guard = self.bool(guard);
        self.line(depth, &format!("if ({guard}) {{"));
        depth + 1
    }

    /// Writes the initial state of a fragment and of the fragments inside it.
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
        for slot in self.kept() {
            let Region::State(f) = self.flat.registers.region(slot) else {
                continue;
            };
            let mut content = Vec::new();
            self.flat.registers.append_initial(slot, &mut content);
            for (k, bits) in (0..).zip(content).filter(|_| inside(f.0)) {
                let value = literal(bits, self.types[slot.index()]);
                lines.push(format!(
                    "{} = {value};",
                    self.names.cell(self.flat, slot, k)
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
        let words = self.flat.words(op).to_vec();
        match op.kind {
            OpKind::Run(prim, form) => self.run(op, prim, form, depth, declares),
            OpKind::Copy => {
                let (from, to) = (Register(words[0]), Register(words[1]));
                for k in 0..self.flat.registers.size(to) {
                    let value = self.cell(from, k, self.types[to.index()]);
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
        let ty = self.flat.tables.actuators[number as usize].port.ty;
        let cells = inputs.iter().flat_map(|s| {
            let slot = Register(*s);
            (0..self.flat.registers.size(slot)).map(move |k| (slot, k))
        });
        let cells: Vec<String> = cells
            .map(|(slot, k)| self.cell(slot, k, scalar(ty)))
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
        let operands = self.operands(op, prim.desc(), form, row);
        if !row.before.is_empty() {
            let text = self.fill(row.before, &operands, 0);
            self.line(depth, &text);
        }
        let mut cell = 0;
        for (slot, present) in operands.outputs.clone() {
            for k in 0..self.flat.registers.size(slot) {
                let text = self.fill(row.cell(cell), &operands, k);
                self.assign(depth, declares, slot, k, &text);
                cell += 1;
            }
            if let Some(present) = present {
                let text = self.fill(row.present, &operands, 0);
                self.assign(depth, declares, present, 0, &text);
            }
        }
    }

    fn assign(&mut self, depth: usize, declares: bool, slot: Register, k: u32, value: &str) {
        let name = self.names.cell(self.flat, slot, k);
        let declares = declares && self.flat.registers.region(slot) == Region::Value;
        let line = match declares {
            true => format!(
                "const {} {name} = {value};",
                c_type(self.types[slot.index()])
            ),
            false => format!("{name} = {value};"),
        };
        self.line(depth, &line);
    }

    fn operands(&mut self, op: Op, desc: &'static PrimDesc, form: Form, row: &CForm) -> Operands {
        let mut operands = Operands {
            inputs: Vec::new(),
            outputs: Vec::new(),
            state: String::new(),
        };
        let words = self.flat.words(op);
        let mut at = 0;
        for field in operand_layout(desc, form) {
            let (slot, last) = (Register(words[at]), words[at + field.words() - 1]);
            let present = field.has_presence.then_some(Register(last));
            at += field.words();
            match field.role {
                OperandRole::Output(_) => operands.outputs.push((slot, present)),
                OperandRole::State => operands.state = format!("state->s{}", slot.0),
                part => operands.inputs.push((slot, expected(desc, part), present)),
            }
        }
        if !matches!(desc.state, StateSize::None) {
            let name = operands.state.trim_start_matches("state->").to_owned();
            self.state.push((row.state[0], name));
        }
        operands
    }

    /// Substitutes the placeholders in braces.
    fn fill(&self, form: &str, operands: &Operands, k: u32) -> String {
        let mut out = String::new();
        let mut rest = form;
        while let Some((before, after)) = rest.split_once('{') {
            let Some((name, after)) = after.split_once('}') else {
                break;
            };
            out.push_str(before);
            out.push_str(&self.operand(name, operands, k));
            rest = after;
        }
        out.push_str(rest);
        out
    }

    fn operand(&self, name: &str, operands: &Operands, k: u32) -> String {
        match name {
            "s" => return operands.state.clone(),
            "dt" => return literal(self.dt.to_bits(), Scalar::Real),
            "tick" => return real_literal(self.tick_ns as f64),
            _ => {}
        }
        let (letter, rest) = name.split_at(1);
        let index = usize::from(letter.as_bytes()[0] - b'a');
        let Some(&(slot, ty, present)) = operands.inputs.get(index) else {
            return String::new();
        };
        match rest {
            "?" => present.map_or("true".to_owned(), |p| self.bool(p)),
            "" => self.cell(slot, k.min(self.flat.registers.size(slot) - 1), ty),
            cell => self.cell(slot, cell.parse().unwrap_or(0), ty),
        }
    }

    fn bool(&self, slot: Register) -> String {
        self.cell(slot, 0, Scalar::Bool)
    }

    /// The expression for slot `k` of a register: a variable or a constant.
    fn cell(&self, slot: Register, k: u32, ty: Scalar) -> String {
        if self.flat.registers.region(slot) != Region::Constant {
            return self.names.cell(self.flat, slot, k);
        }
        let mut content = Vec::new();
        self.flat.registers.append_initial(slot, &mut content);
        literal(content.get(k as usize).copied().unwrap_or(0), ty)
    }

    /// Writes the assignments to the state of delays, after everything else was computed.
    fn latches(&mut self, id: ScopeId, depth: usize) {
        let flat = self.flat;
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
                let value = self.cell(*from, k, self.types[to.index()]);
                let name = self.names.cell(flat, *to, k);
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

/// Operands of one operation.
struct Operands {
    /// Inputs, then parameters.
    inputs: Vec<(Register, Scalar, Option<Register>)>,
    outputs: Vec<(Register, Option<Register>)>,
    state: String,
}

fn indexed(name: &str, cells: u32, k: u32) -> String {
    match cells {
        1 => name.to_owned(),
        _ => format!("{name}_{k}"),
    }
}

/// A constant in C.
fn literal(bits: u64, ty: Scalar) -> String {
    match ty {
        Scalar::Bool => if bits != 0 { "true" } else { "false" }.to_owned(),
        Scalar::Int | Scalar::Time if bits == 1 << 63 => "INT64_MIN".to_owned(),
        Scalar::Int | Scalar::Time => format!("INT64_C({})", bits.cast_signed()),
        _ => real_literal(f64::from_bits(bits)),
    }
}

fn real_literal(v: f64) -> String {
    if v.is_nan() {
        return "NAN".to_owned();
    }
    if v.is_infinite() {
        return if v > 0.0 { "INFINITY" } else { "-INFINITY" }.to_owned();
    }
    let text = format!("{v:?}");
    // Without parentheses, `-{a}` with a negative constant would become the C operator `--`.
    if v.is_sign_negative() {
        format!("({text})")
    } else {
        text
    }
}
