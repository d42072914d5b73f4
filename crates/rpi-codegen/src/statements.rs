//! C statements of the steps of an image.

use crate::Options;
use crate::access::{CallOperand, calls, copies, operand_len, param_port, shared_type, used_prim};
use crate::c_type::{CType, is_single, port_element};
use crate::functions::{Argument, Function, Part, function};
use crate::identifiers::tokens;
use crate::literals::literal;
use crate::order::Unit;
use crate::parts::Node;
use crate::ports::Interface;
use crate::scopes::Lifetime;
use crate::slots::Slots;
use crate::variables::{Storage, Variable, Variables, convert};
use rpi_image::PortType;
use rpi_image::image::{Form, Image, SlotRange, Step};
use rpi_image::operands::OperandRole;
use rpi_prims::Prim;
use std::collections::{BTreeMap, BTreeSet};

/// Writer of the C statements of an image, with everything that the statements refer to.
pub(crate) struct Emitter<'a> {
    pub(crate) image: &'a Image,
    pub(crate) slots: &'a Slots,
    pub(crate) variables: &'a Variables,
    pub(crate) interface: &'a Interface,
    pub(crate) options: &'a Options<'a>,
    /// Functions of primitives, by name.
    pub(crate) functions: BTreeMap<String, Function>,
    /// Arrays of constants: first slot, length and type, with the name.
    pub(crate) constants: BTreeMap<(u32, u32, CType), String>,
    /// Places in the source that faults report, as indices into [`DebugInfo::locations`](rpi_image::DebugInfo).
    pub(crate) places: Vec<u32>,
    /// Fragments that a step restores.
    pub(crate) resets: BTreeSet<u32>,
    /// Number of elementary operations of all steps.
    pub(crate) work: u64,
    last_line: Option<(String, u32)>,
}

impl<'a> Emitter<'a> {
    pub(crate) fn new(
        image: &'a Image,
        slots: &'a Slots,
        variables: &'a Variables,
        interface: &'a Interface,
        options: &'a Options<'a>,
    ) -> Emitter<'a> {
        Emitter {
            image,
            slots,
            variables,
            interface,
            options,
            functions: BTreeMap::new(),
            constants: BTreeMap::new(),
            places: Vec::new(),
            resets: BTreeSet::new(),
            work: 0,
            last_line: None,
        }
    }

    /// Returns the statements of units. `outputs` writes those of the results of the cycle.
    pub(crate) fn units(
        &mut self,
        units: &[Unit],
        outputs: &dyn Fn(&mut Self) -> Vec<String>,
    ) -> Vec<Node> {
        let mut nodes = Vec::new();
        for unit in units {
            match unit {
                Unit::Step(step) => nodes.extend(self.step(step).into_iter().map(Node::Line)),
                Unit::Outputs => nodes.extend(outputs(self).into_iter().map(Node::Line)),
                Unit::Block { unless, body } => {
                    let guard = self.variables.value(self.slots, *unless, CType::Bool);
                    self.last_line = None;
                    let body = self.units(body, outputs);
                    self.last_line = None;
                    if !body.is_empty() {
                        nodes.push(Node::Block {
                            head: format!("if ({guard})"),
                            body,
                        });
                    }
                }
            }
        }
        nodes
    }

    fn step(&mut self, step: &Step) -> Vec<String> {
        match *step {
            Step::Run {
                prim,
                form,
                start,
                len,
            } => {
                let Some(prim) = used_prim(self.image, prim) else {
                    return Vec::new();
                };
                let calls = calls(self.image, &prim.desc, form, SlotRange { start, len });
                let lines = calls.iter().flat_map(|call| self.run(prim, form, call));
                lines.collect()
            }
            Step::Copy { at, len } => self.copy(&copies(self.image, at, len)),
            Step::Skip { .. } => Vec::new(),
            Step::Reset { unless, fragment } => {
                self.resets.insert(fragment);
                let guard = self.variables.value(self.slots, unless, CType::Bool);
                let call = format!("{}_reset_{fragment}(s);", self.options.name);
                vec![format!("if (!{guard}) {{\n  {call}\n}}")]
            }
            Step::Actuate { actuator } => self.actuate(actuator),
            Step::Call { function } => self.call_device(function),
        }
    }

    /// Returns the index of the place of the node that writes a slot, for faults.
    pub(crate) fn place(&mut self, slot: u32) -> usize {
        let origins = &self.image.debug.origins;
        let found = origins.binary_search_by_key(&slot, |o| o.0);
        let location = found.map_or(u32::MAX, |k| origins[k].1);
        let known = self.places.iter().position(|p| *p == location);
        known.unwrap_or_else(|| {
            self.places.push(location);
            self.places.len() - 1
        })
    }

    /// Returns a comment with the place of the node that writes a slot, if it is not that of the last statement.
    fn place_comment(&mut self, slot: u32) -> Option<String> {
        let location = self.image.location_of(slot)?;
        let place = (self.options.locate)(location)?;
        let line = (place.file, place.line);
        if self.last_line.as_ref() == Some(&line) {
            return None;
        }
        let text = match self.options.line_directives {
            true => format!("#line {} \"{}\"", line.1, escaped(&line.0)),
            false => format!("/* {}:{} */", line.0.replace("*/", "* /"), line.1),
        };
        self.last_line = Some(line);
        Some(text)
    }

    fn run(&mut self, prim: &Prim, form: Form, call: &[CallOperand<'_>]) -> Vec<String> {
        let outputs = call
            .iter()
            .filter(|o| matches!(o.0.role, OperandRole::Output(_)));
        let first_output = outputs.map(|o| o.1[0]).next();
        let mut lines: Vec<String> = Vec::new();
        lines.extend(first_output.and_then(|slot| self.place_comment(slot)));
        self.work += u64::from(prim.desc.work);
        let Some(function) = function(prim, form == Form::Total) else {
            return lines;
        };
        let place = first_output.unwrap_or(0);
        let arguments = self.arguments(prim, &function, call, place);
        match (function.expression, first_output) {
            (Some(expression), Some(slot)) => {
                let value = self.expression(expression, &function, &arguments);
                let ty = port_element(prim.desc.outputs[0].ty).into();
                lines.push(self.assignment(slot, ty, &value));
            }
            _ => {
                lines.extend(self.declarations(call));
                let text = format!("{}({});", function.name, arguments.join(", "));
                // A form for all ports that are present ignores the presences of the outputs.
                lines.push(match arguments.iter().any(|a| a == "&present") {
                    true => format!("{{\n  bool present;\n  {text}\n}}"),
                    false => text,
                });
            }
        }
        if lines.last().is_some_and(|l| l.contains(&function.name)) {
            self.functions.insert(function.name.clone(), function);
        }
        lines
    }

    /// Returns the value of an out-port: the expression of the primitive with its operands in place of the names, or a
    /// call of its function where compilers would warn about equal or constant operands.
    fn expression(&self, expression: &str, function: &Function, arguments: &[String]) -> String {
        let operands = function.parameters.iter().zip(arguments);
        let operands: BTreeMap<&str, &String> =
            operands.map(|(p, a)| (p.name.as_str(), a)).collect();
        let is_port = |name: &&str| !["cx", "at"].contains(name);
        let ports = operands.iter().filter(|(name, _)| is_port(name));
        let ports: Vec<&str> = ports.map(|(_, text)| text.as_str()).collect();
        let distinct: BTreeSet<&str> = ports.iter().copied().collect();
        if distinct.len() < ports.len() || ports.iter().all(|text| is_constant(text)) {
            return format!("{}({})", function.name, arguments.join(", "));
        }
        let parts = tokens(expression).into_iter();
        let replaced = parts.map(|part| operands.get(part).map_or(part, |a| a.as_str()));
        replaced.collect()
    }

    pub(crate) fn assignment(&self, slot: u32, ty: CType, value: &str) -> String {
        let target = self.variables.slot(self.slots, slot);
        let Some(variable) = self.variables.of(slot) else {
            return String::new();
        };
        let value = match variable.ty == ty {
            true => value.to_owned(),
            false => convert(&format!("({value})"), ty, variable.ty),
        };
        if self.is_unread(variable) {
            // The operation may fault, so a call stays.
            return match value.contains('(') {
                true => format!("(void)({value});"),
                false => String::new(),
            };
        }
        match variable.storage {
            Storage::Scope => format!("const {} {target} = {value};", variable.ty.name()),
            _ => format!("{target} = {value};"),
        }
    }

    /// Returns whether no step and no table reads a variable of a cycle. Compilers warn about such variables.
    fn is_unread(&self, variable: &Variable) -> bool {
        let mut slots = variable.slots.start..variable.slots.end();
        matches!(variable.storage, Storage::Scope | Storage::Cycle)
            && slots.all(|slot| self.slots.lifetime(slot) == Lifetime::Unread)
    }

    /// Returns the declarations of the variables that a call writes.
    fn declarations(&self, call: &[CallOperand<'_>]) -> Vec<String> {
        let mut lines = Vec::new();
        for (operand, words) in call {
            let OperandRole::Output(_) = operand.role else {
                continue;
            };
            let presence = operand.has_presence.then(|| words[words.len() - 1]);
            for slot in std::iter::once(words[0]).chain(presence) {
                let variable = self.variables.of(slot);
                let Some(variable) = variable.filter(|v| v.storage == Storage::Scope) else {
                    continue;
                };
                // An absent output keeps this value, which is passed on with its presence.
                let declared = declarator(variable.ty, &variable.name, variable.slots.len);
                lines.push(format!("{declared} = {};", zero(variable)));
            }
        }
        lines
    }

    fn arguments(
        &mut self,
        prim: &Prim,
        function: &Function,
        call: &[CallOperand<'_>],
        slot: u32,
    ) -> Vec<String> {
        let parameters = function.parameters.iter();
        parameters
            .map(|p| self.argument(prim, p.argument, call, slot))
            .collect()
    }

    fn argument(
        &mut self,
        prim: &Prim,
        argument: Argument,
        call: &[CallOperand<'_>],
        slot: u32,
    ) -> String {
        let find = |role: OperandRole| call.iter().find(|o| o.0.role == role);
        let state = || find(OperandRole::State).map_or(&[][..], |o| o.1);
        match argument {
            Argument::Context => "cx".to_owned(),
            Argument::Place => self.place(slot).to_string(),
            Argument::State(k) => {
                let sizes = prim.c.map_or(&[][..], |c| c.state).iter().take(k);
                let offset: u32 = sizes.map(|s| s.slots()).sum();
                self.variables.pointer(self.slots, state()[0] + offset)
            }
            Argument::Ring => self.variables.pointer(self.slots, state()[0]),
            Argument::RingLength => format!("{}U", state()[1]),
            Argument::Input(k, part) => {
                let ty = prim.desc.inputs[k].ty;
                find(OperandRole::Input(k)).map_or_else(String::new, |o| self.input(o, ty, part))
            }
            Argument::Param(k, part) => {
                let ty = param_port(prim.desc.params[k].ty);
                find(OperandRole::Param(k)).map_or_else(String::new, |o| self.input(o, ty, part))
            }
            Argument::Output(k, part) => {
                find(OperandRole::Output(k)).map_or_else(String::new, |o| self.output(o, part))
            }
        }
    }

    fn input(&mut self, (operand, words): &CallOperand<'_>, ty: PortType, part: Part) -> String {
        let element = port_element(ty);
        match part {
            Part::FirstSize => words[1].to_string(),
            Part::SecondSize => words[2].to_string(),
            Part::Presence if operand.has_presence => {
                let present = words[words.len() - 1];
                self.variables.value(self.slots, present, CType::Bool)
            }
            Part::Presence => "true".to_owned(),
            Part::Value if is_single(ty) => {
                self.variables
                    .value(self.slots, words[0], CType::of(element))
            }
            Part::Value => {
                let len = operand_len(*operand, words, element.slots());
                self.array(words[0], len, CType::of(element))
            }
        }
    }

    /// Returns a pointer to adjacent slots. Constants get an array of their own.
    pub(crate) fn array(&mut self, start: u32, len: u32, ty: CType) -> String {
        if len == 0 {
            return "NULL".to_owned();
        }
        match self.variables.of(start) {
            Some(_) => self.variables.pointer(self.slots, start),
            None => {
                let name = || format!("rpi_constant_{start}_{len}");
                self.constants
                    .entry((start, len, ty))
                    .or_insert_with(name)
                    .clone()
            }
        }
    }

    fn output(&self, (operand, words): &CallOperand<'_>, part: Part) -> String {
        match part {
            Part::FirstSize => words[1].to_string(),
            Part::SecondSize => words[2].to_string(),
            Part::Value => self.variables.pointer(self.slots, words[0]),
            Part::Presence if operand.has_presence => {
                self.variables.pointer(self.slots, words[words.len() - 1])
            }
            Part::Presence => "&present".to_owned(),
        }
    }

    /// Returns the assignments of a copy. Runs of adjacent slots are copied together.
    fn copy(&mut self, pairs: &[(u32, u32)]) -> Vec<String> {
        let mut lines = Vec::new();
        let mut rest = pairs;
        while let Some(&(from, to)) = rest.first() {
            let run = self.run_length(rest);
            if run >= 4 {
                let ty = self.slots.ty(to);
                let source = self.array(from, run as u32, ty);
                let target = self.variables.pointer(self.slots, to);
                lines.push(format!(
                    "memcpy({target}, {source}, {run}U * sizeof({}));",
                    ty.name()
                ));
                rest = &rest[run..];
            } else {
                let value = self.variables.value(self.slots, from, self.slots.ty(to));
                lines.push(self.assignment(to, self.slots.ty(to), &value));
                rest = &rest[1..];
            }
        }
        lines
    }

    /// Returns the number of pairs at the start of a copy that are adjacent in two different arrays of one type.
    fn run_length(&self, pairs: &[(u32, u32)]) -> usize {
        let (from, to) = pairs[0];
        let (source, target) = (self.slots.object(from), self.slots.object(to));
        let constant = self.variables.of(from).is_none();
        let apart = source != target && (constant || self.slots.ty(from) == self.slots.ty(to));
        let inside = |slot: u32, range: SlotRange| slot < range.end();
        let adjacent = (0..).zip(pairs).take_while(|(k, pair)| {
            **pair == (from + k, to + k)
                && (constant && self.variables.of(pair.0).is_none() || inside(pair.0, source))
                && inside(pair.1, target)
        });
        if apart { adjacent.count() } else { 1 }
    }

    /// Returns the value of a slot as an expression of its own type, for the devices.
    pub(crate) fn word(&self, slot: u32) -> (String, CType) {
        let ty = shared_type(self.variables.of(slot).map(|v| v.ty));
        (self.variables.value(self.slots, slot, ty), ty)
    }
}

/// Returns whether the C text of an operand is a constant.
fn is_constant(text: &str) -> bool {
    let is_literal = text.starts_with(|c: char| c.is_ascii_digit() || c == '(');
    is_literal
        || text.starts_with("INT64_")
        || text.starts_with("rpi_")
        || ["true", "false"].contains(&text)
}

/// Returns the declaration of a variable without the semicolon.
pub(crate) fn declarator(ty: CType, name: &str, len: u32) -> String {
    match len {
        1 => format!("{} {name}", ty.name()),
        len => format!("{} {name}[{len}]", ty.name()),
    }
}

/// Returns the C text of the value 0 for a variable.
pub(crate) fn zero(variable: &Variable) -> &'static str {
    match (variable.slots.len, variable.ty) {
        (1, CType::Bool) => "false",
        (1, CType::Real) => "0.0",
        (1, CType::Word) => "0U",
        (1, CType::Int) => "0",
        _ => "{0}",
    }
}

/// Returns the initial value of a slot as C text.
pub(crate) fn initial(slots: &Slots, slot: u32, ty: CType) -> String {
    literal(slots.initial(slot), ty)
}

/// Returns a text as the content of a C string.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            '?' => out.push_str("\\?"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}
