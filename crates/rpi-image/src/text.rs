//! Text form of an image (`--emit image`): tables, then one line per step with symbolic names.

use crate::desc::{PortType, PrimDesc};
use crate::image::{CommandEnd, Form, Image, Signal, SlotRange, Step, TRUE};
use crate::operands::{Operand, OperandRole, group_words, operand_layout};
use crate::types::Scalar;
use crate::verify::PrimLookup;
use alloc::collections::BTreeMap;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use alloc::{format, vec};
use core::fmt::Write;

/// Returns a readable text of an image, with one line per table entry and per step. `catalogue` provides the
/// declarations of primitives; the operand words of an unknown primitive are printed as numbers.
#[must_use]
pub fn print(image: &Image, catalogue: PrimLookup<'_>) -> String {
    let printer = Printer {
        image,
        catalogue,
        names: slot_names(image),
    };
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = printer.write_image(&mut out);
    out
}

struct Printer<'a> {
    image: &'a Image,
    catalogue: PrimLookup<'a>,
    names: BTreeMap<u32, String>,
}

/// Returns a readable name for each slot of a probe, sensor, input or flow of the core. The presence slot has the name
/// of the value with `?`. Constants get no name.
fn slot_names(image: &Image) -> BTreeMap<u32, String> {
    let mut names = BTreeMap::new();
    let probes = image.debug.probes.iter();
    let tables = probes
        .map(|p| (p.value, image.probe_name(p)))
        .chain(image.sensors.iter().map(|s| (s.value, s.port.to_string())))
        .chain(image.inputs.iter().map(|i| (i.value, i.key.clone())))
        .chain(
            image
                .flows
                .iter()
                .map(|f| (f.value, format!("{:?}", f.kind))),
        );
    for (signal, name) in tables {
        names
            .entry(signal.present)
            .or_insert_with(|| format!("{name}?"));
        names.entry(signal.start).or_insert(name);
    }
    names.retain(|cell, _| *cell >= image.layout.constants);
    names
}

impl Printer<'_> {
    fn write_image(&self, out: &mut String) -> core::fmt::Result {
        let i = self.image;
        let l = i.layout;
        writeln!(out, "image {} period {} ns", i.name, i.period_ns)?;
        writeln!(
            out,
            "cells {} (constants to {}, external to {}, state to {}), steps {} + {}, words {}",
            l.end,
            l.constants,
            l.external,
            l.state,
            i.steps.len(),
            i.commit.len(),
            i.code.len()
        )?;
        self.tables(out)?;
        writeln!(out, "evaluate")?;
        self.steps(out, &i.steps)?;
        writeln!(out, "commit")?;
        self.steps(out, &i.commit)
    }

    fn tables(&self, out: &mut String) -> core::fmt::Result {
        let i = self.image;
        for f in &i.fragments {
            let state = slot_range_text(f.state);
            writeln!(
                out,
                "fragment /{} when {} state {state}",
                f.path,
                self.cell(f.active)
            )?;
        }
        for s in &i.sensors {
            writeln!(out, "sensor {} -> {}", s.port, self.signal(s.value))?;
        }
        for p in &i.inputs {
            writeln!(out, "input {} -> {}", p.key, self.signal(p.value))?;
        }
        for f in &i.flows {
            writeln!(out, "flow {:?} -> {}", f.kind, self.signal(f.value))?;
        }
        for e in &i.exports {
            writeln!(out, "export {} = {}", e.key, self.signal(e.value))?;
        }
        self.end(out)
    }

    fn end(&self, out: &mut String) -> core::fmt::Result {
        match &self.image.end {
            CommandEnd::Results(results) => results.iter().try_for_each(|r| {
                writeln!(
                    out,
                    "{:?} {} when {}",
                    r.kind,
                    r.name,
                    self.signal(r.condition)
                )
            }),
            CommandEnd::Ports { terminate, fail } => {
                let ports = [("terminate", terminate), ("fail", fail)];
                ports.iter().try_for_each(|(name, port)| match port {
                    Some(signal) => writeln!(out, "{name} = {}", self.signal(*signal)),
                    None => Ok(()),
                })
            }
        }
    }

    fn steps(&self, out: &mut String, steps: &[Step]) -> core::fmt::Result {
        let mut ends: Vec<u32> = Vec::new();
        for (pc, step) in (0u32..).zip(steps) {
            ends.retain(|&end| end > pc);
            let indent = 2 * ends.len();
            writeln!(out, "{pc:6} {:indent$}{}", "", self.step(step))?;
            if let Step::Skip { target: to, .. } = step {
                ends.push(*to);
            }
        }
        Ok(())
    }

    fn step(&self, step: &Step) -> String {
        match *step {
            Step::Run {
                prim,
                form,
                start: at,
                len,
            } => self.run(prim, form, self.words(at, len)),
            Step::Copy { at, len } => self.copies(self.words(at, len)),
            Step::Skip { unless, target: to } => {
                format!("skip to {to} unless {}", self.cell(unless))
            }
            Step::Reset { unless, fragment } => {
                let path = self
                    .image
                    .fragments
                    .get(fragment as usize)
                    .map_or("?", |f| &f.path);
                format!("reset /{path} unless {}", self.cell(unless))
            }
            Step::Actuate { actuator } => self.actuate(actuator),
            Step::Call { function } => self.call(function),
        }
    }

    fn words(&self, at: u32, len: u32) -> &[u32] {
        self.image
            .code
            .get(SlotRange { start: at, len }.range())
            .unwrap_or(&[])
    }

    fn copies(&self, words: &[u32]) -> String {
        let pairs = words.chunks_exact(2);
        let copies = pairs.map(|w| format!("{} = {}", self.cell(w[1]), self.cell(w[0])));
        format!("copy {}", join(copies, "; "))
    }

    fn actuate(&self, actuator: u32) -> String {
        let Some(a) = self.image.actuators.get(actuator as usize) else {
            return format!("actuate {actuator}");
        };
        let inputs = join(a.inputs.iter().map(|c| self.cell(c.start)), ", ");
        let answers = join(a.responses.iter().map(|(_, c)| self.cell(*c)), ", ");
        format!("actuate {} = {inputs} -> {answers}", a.port)
    }

    fn call(&self, function: u32) -> String {
        let Some(f) = self.image.functions.get(function as usize) else {
            return format!("call {function}");
        };
        let arguments = join(f.arguments.iter().map(|c| self.cell(c.start)), ", ");
        let results = join(f.results.iter().map(|c| self.cell(c.start)), ", ");
        format!("call {results} = {}({arguments})", f.port)
    }

    fn run(&self, prim: u16, form: Form, words: &[u32]) -> String {
        let name = self
            .image
            .prims_used
            .get(usize::from(prim))
            .map_or("?", |p| &p.name);
        let mark = if form == Form::Optional { "?" } else { "" };
        let groups = match (self.catalogue)(name) {
            Some(desc) => self.groups(desc, form, words),
            None => format!("{words:?}"),
        };
        format!("{name}{mark} {groups}")
    }

    fn groups(&self, desc: &PrimDesc, form: Form, words: &[u32]) -> String {
        let fields = operand_layout(desc, form);
        let groups = words.chunks_exact(group_words(&fields).max(1));
        join(groups.map(|g| self.group(desc, &fields, g)), "; ")
    }

    fn group(&self, desc: &PrimDesc, fields: &[Operand], words: &[u32]) -> String {
        let (mut outputs, mut inputs) = (vec![], vec![]);
        let mut words = words;
        for field in fields {
            let (mine, rest) = words.split_at(field.words());
            words = rest;
            let text = self.operand(desc, *field, mine);
            match field.role {
                OperandRole::Output(_) => outputs.push(text),
                OperandRole::State => inputs.push(format!("[{text}]")),
                OperandRole::Input(_) | OperandRole::Param(_) => inputs.push(text),
            }
        }
        format!("{} = {}", outputs.join(", "), inputs.join(", "))
    }

    fn operand(&self, desc: &PrimDesc, field: Operand, words: &[u32]) -> String {
        let scalar = match field.role {
            OperandRole::Input(k) => scalar_of(desc.inputs[k].ty),
            OperandRole::Param(_) | OperandRole::Output(_) | OperandRole::State => None,
        };
        let value = self.value(words[0], scalar);
        match words.last() {
            Some(&present) if field.has_presence && present != TRUE => {
                format!("{value} if {}", self.cell(present))
            }
            _ => value,
        }
    }

    /// Returns the text of a slot: the number that it holds if it is a constant real, integer or time according to
    /// `scalar`, else the name of the slot.
    fn value(&self, cell: u32, scalar: Option<Scalar>) -> String {
        let bits = || {
            let found = self.image.init.binary_search_by_key(&cell, |c| c.0);
            found.map_or(0, |k| self.image.init[k].1)
        };
        match scalar {
            Some(Scalar::Real) if cell < self.image.layout.constants => {
                format!("{:?}", f64::from_bits(bits()))
            }
            Some(Scalar::Int | Scalar::Time) if cell < self.image.layout.constants => {
                bits().cast_signed().to_string()
            }
            _ => self.cell(cell),
        }
    }

    fn signal(&self, s: Signal) -> String {
        let value = self.cell(s.start);
        match s.present {
            TRUE => format!("{value}: {}", s.ty),
            p => format!("{value}: {} if {}", s.ty, self.cell(p)),
        }
    }

    fn cell(&self, cell: u32) -> String {
        let l = self.image.layout;
        let region = match cell {
            0 => return "false".into(),
            1 => return "true".into(),
            c if c < l.constants => 'c',
            c if c < l.external => 'x',
            c if c < l.state => 's',
            _ => 'v',
        };
        match self.names.get(&cell) {
            Some(name) => format!("{region}{cell}:{name}"),
            None => format!("{region}{cell}"),
        }
    }
}

fn scalar_of(ty: PortType) -> Option<Scalar> {
    match ty {
        PortType::Scalar(s) => Some(s),
        PortType::Array(_) | PortType::Matrix => None,
    }
}

fn slot_range_text(c: SlotRange) -> String {
    format!("{}..{}", c.start, c.end())
}

fn join(parts: impl Iterator<Item = String>, by: &str) -> String {
    parts.collect::<Vec<_>>().join(by)
}

impl core::fmt::Display for crate::image::DevicePort {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (device, port, index) = (&self.device, &self.port, self.index);
        write!(f, "{device}.{port}[{index}]: {}", self.ty)
    }
}
