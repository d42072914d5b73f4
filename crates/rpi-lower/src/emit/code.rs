//! Emission of steps and operand words.

use super::cells::Layouts;
use crate::access::Access;
use crate::flat::{Flat, Item, Op, ScopeId, Work, index};
use crate::options::{LowerOptions, Observe};
use crate::slots::Slot;
use rpi_image::Image;
use rpi_image::hash::signature;
use rpi_image::image::{Actuator, Cells, Form, Function, PrimUse, Step, TRUE};
use rpi_prims::PrimId;
use rustc_hash::FxHashMap;

/// Writes the evaluation steps and the commit steps.
pub(super) fn write(flat: &Flat, layouts: &Layouts, options: &LowerOptions<'_>, image: &mut Image) {
    image.code.reserve(flat.words.len());
    let mut writer = Writer {
        flat,
        layouts,
        rows: options.observe == Observe::Exports,
        border: 0,
        image,
        prims: FxHashMap::default(),
    };
    writer.scope(ScopeId::ROOT);
    writer.commit(ScopeId::ROOT);
}

struct Writer<'a> {
    flat: &'a Flat,
    layouts: &'a Layouts,
    /// Merge consecutive calls of the same primitive into one step.
    rows: bool,
    /// Index of the first step after the last jump or jump target.
    border: usize,
    image: &'a mut Image,
    prims: FxHashMap<PrimId, u16>,
}

impl Writer<'_> {
    fn scope(&mut self, id: ScopeId) {
        let flat = self.flat;
        let scope = &flat.scopes[id.index()];
        let skip = self.skip(scope.guard, |image| &mut image.steps);
        if let Some((unless, fragment)) = scope.reset {
            let unless = self.layouts.cell(unless);
            self.step(Step::Reset { unless, fragment }, crate::flat::NO_NODE);
        }
        for item in &scope.items {
            match item {
                Item::Op(op) => self.op(flat.ops[*op as usize]),
                Item::Scope(inner) => self.scope(*inner),
            }
        }
        self.land(skip);
    }

    /// Sets the target of an open skip to the current end. Removes the skip if nothing follows it.
    fn land(&mut self, skip: Option<usize>) {
        let steps = &mut self.image.steps;
        if skip.is_some_and(|at| at + 1 == steps.len()) {
            steps.pop();
            self.image.trace.pop();
        } else {
            land(steps, skip);
        }
        self.border = self.image.steps.len();
    }

    /// Opens a skip and returns its index; `None` for a guard that is always true.
    fn skip(&mut self, guard: Slot, steps: impl Fn(&mut Image) -> &mut Vec<Step>) -> Option<usize> {
        if guard == Slot::TRUE {
            return None;
        }
        let unless = self.layouts.cell(guard);
        let at = steps(self.image).len();
        steps(self.image).push(Step::Skip { unless, to: 0 });
        self.image
            .trace
            .resize(self.image.steps.len(), crate::flat::NO_NODE);
        Some(at)
    }

    fn step(&mut self, step: Step, node: u32) {
        self.image.steps.push(step);
        self.image.trace.push(node);
    }

    fn op(&mut self, op: Op) {
        let at = index(self.image.code.len());
        let step = match op.work {
            Work::Run(prim, form) => {
                self.words(prim, form, self.flat.words(op));
                let prim = self.prim(prim);
                Step::Run {
                    prim,
                    form,
                    at,
                    len: op.len,
                }
            }
            Work::Copy => {
                let words = self.flat.words(op);
                self.pairs(Slot(words[0]), Slot(words[1]));
                let len = index(self.image.code.len()) - at;
                Step::Copy { at, len }
            }
            Work::Actuate(number, inputs) => self.actuate(number, inputs, self.flat.words(op)),
            Work::Call(number, inputs) => self.call(number, inputs, self.flat.words(op)),
        };
        // A row must not extend across the end of a skip.
        let last = self.image.steps.get_mut(self.border..);
        if !(self.rows && joined(last.and_then(<[Step]>::last_mut), step)) {
            self.step(step, op.node);
        }
    }

    fn actuate(&mut self, number: u32, inputs: u32, words: &[u32]) -> Step {
        let table = &self.flat.tables.actuators[number as usize];
        let (inputs, answers) = words.split_at(inputs as usize);
        let answers = table.answers.iter().zip(answers);
        let actuator = Actuator {
            port: table.port.clone(),
            inputs: inputs.iter().map(|s| self.cells(Slot(*s))).collect(),
            answers: answers
                .map(|(a, s)| (*a, self.layouts.cell(Slot(*s))))
                .collect(),
        };
        self.image.actuators.push(actuator);
        let actuator = index(self.image.actuators.len() - 1);
        Step::Actuate { actuator }
    }

    fn call(&mut self, number: u32, inputs: u32, words: &[u32]) -> Step {
        let table = &self.flat.tables.functions[number as usize];
        let (arguments, results) = words.split_at(inputs as usize);
        let (results, found) = results.split_at(results.len() - usize::from(table.maybe));
        let function = Function {
            port: table.port.clone(),
            arguments: arguments.iter().map(|s| self.cells(Slot(*s))).collect(),
            results: results.iter().map(|s| self.cells(Slot(*s))).collect(),
            present: found.first().map_or(TRUE, |s| self.layouts.cell(Slot(*s))),
        };
        self.image.functions.push(function);
        let function = index(self.image.functions.len() - 1);
        Step::Call { function }
    }

    fn cells(&self, slot: Slot) -> Cells {
        let (at, len) = (self.layouts.cell(slot), self.flat.slots.cells(slot));
        Cells { at, len }
    }

    /// Emits operand words with registers replaced by memory slots.
    fn words(&mut self, prim: PrimId, form: Form, words: &[u32]) {
        let shape = self.flat.shapes.get(prim, form);
        let cell = |(word, access): (&u32, &Access)| match access {
            Access::Number => *word,
            _ => self.layouts.cell(Slot(*word)),
        };
        self.image.code.extend(words.iter().zip(shape).map(cell));
    }

    fn pairs(&mut self, from: Slot, to: Slot) {
        let (a, b) = (self.layouts.cell(from), self.layouts.cell(to));
        for k in 0..self.flat.slots.cells(to) {
            self.image.code.extend([a + k, b + k]);
        }
    }

    fn prim(&mut self, prim: PrimId) -> u16 {
        let table = &mut self.image.prims;
        *self.prims.entry(prim).or_insert_with(|| {
            let desc = prim.desc();
            table.push(PrimUse {
                name: desc.name.to_owned(),
                signature: signature(desc),
            });
            // The registry has fewer than 2^16 primitives.
            (table.len() - 1) as u16
        })
    }

    /// Emits the latches of a scope and of the scopes inside it. Returns true if there were any.
    fn commit(&mut self, id: ScopeId) -> bool {
        let flat = self.flat;
        let scope = &flat.scopes[id.index()];
        let before = self.image.commit.len();
        let skip = self.skip(scope.guard, |image| &mut image.commit);
        let mut any = false;
        for item in &scope.items {
            if let Item::Scope(inner) = item {
                any |= self.commit(*inner);
            }
        }
        let at = index(self.image.code.len());
        for (from, to) in &scope.latches {
            self.pairs(*from, *to);
        }
        let len = index(self.image.code.len()) - at;
        if len > 0 {
            self.image.commit.push(Step::Copy { at, len });
        }
        any |= len > 0;
        if any {
            land(&mut self.image.commit, skip);
        } else {
            self.image.commit.truncate(before);
        }
        any
    }
}

/// Sets the target of an open skip to the current end.
fn land(steps: &mut [Step], skip: Option<usize>) {
    let end = index(steps.len());
    if let Some(Step::Skip { to, .. }) = skip.and_then(|at| steps.get_mut(at)) {
        *to = end;
    }
}

/// Merges a step into the previous one if both are of the same kind. Their words are adjacent.
fn joined(last: Option<&mut Step>, step: Step) -> bool {
    match (last, step) {
        (
            Some(Step::Run {
                prim,
                form,
                at,
                len,
            }),
            Step::Run {
                prim: p,
                form: f,
                at: next,
                len: more,
            },
        ) if *prim == p && *form == f && *at + *len == next => {
            *len += more;
            true
        }
        (
            Some(Step::Copy { at, len }),
            Step::Copy {
                at: next,
                len: more,
            },
        ) if *at + *len == next => {
            *len += more;
            true
        }
        _ => false,
    }
}
