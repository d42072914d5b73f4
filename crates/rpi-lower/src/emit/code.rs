//! Emission of steps and operand words.

use super::layout::MemoryLayout;
use crate::access::Access;
use crate::flat_net::{FlatNet, Item, Op, OpKind, ScopeId, index};
use crate::options::{LowerOptions, Observe};
use crate::registers::Register;
use rpi_image::Image;
use rpi_image::hash::prim_signature;
use rpi_image::image::{ActuatorPort, DeviceFunction, Form, PrimUse, SlotRange, Step, TRUE};
use rpi_prims::PrimId;
use rustc_hash::FxHashMap;

/// Writes the steps of the evaluation phase and of the commit phase, which stores values for the next cycle, to
/// `image`.
pub(super) fn write(
    flat: &FlatNet,
    layouts: &MemoryLayout,
    options: &LowerOptions<'_>,
    image: &mut Image,
) {
    image.code.reserve(flat.words.len());
    let mut writer = Writer {
        flat,
        layouts,
        merges_rows: options.observe == Observe::Exports,
        merge_start: 0,
        image,
        prims: FxHashMap::default(),
    };
    writer.scope(ScopeId::ROOT);
    writer.commit(ScopeId::ROOT);
}

struct Writer<'a> {
    flat: &'a FlatNet,
    layouts: &'a MemoryLayout,
    /// Whether consecutive calls of the same primitive are merged into one step. False if every port must be
    /// observable, which needs a step for each node.
    merges_rows: bool,
    /// Index of the first step that a later step may be merged with: the step after the last jump or jump target.
    /// Merging across a jump target would change the code that a jump skips.
    merge_start: usize,
    image: &'a mut Image,
    prims: FxHashMap<PrimId, u16>,
}

impl Writer<'_> {
    fn scope(&mut self, id: ScopeId) {
        let flat = self.flat;
        let scope = &flat.scopes[id.index()];
        let skip = self.open_skip(scope.guard, |image| &mut image.steps);
        if let Some((unless, fragment)) = scope.reset {
            let unless = self.layouts.slot(unless);
            self.step(Step::Reset { unless, fragment }, crate::flat_net::NO_NODE);
        }
        for item in &scope.items {
            match item {
                Item::Op(op) => self.op(flat.ops[*op as usize]),
                Item::Scope(inner) => self.scope(*inner),
            }
        }
        self.close_skip(skip);
    }

    /// Sets the target of the jump step with index `skip` to the end of the steps so far. Removes the jump if it would
    /// skip no step. Has no effect for `None`.
    fn close_skip(&mut self, skip: Option<usize>) {
        let steps = &mut self.image.steps;
        if skip.is_some_and(|at| at + 1 == steps.len()) {
            steps.pop();
            self.image.debug.step_locations.pop();
        } else {
            land(steps, skip);
        }
        self.merge_start = self.image.steps.len();
    }

    /// Adds a jump over the steps that follow, taken unless `guard` is true, and returns its index. The target is set
    /// later. `None` for a guard that is always true, which needs no jump.
    ///
    /// `steps` selects the list of steps of the image: evaluation or commit.
    fn open_skip(
        &mut self,
        guard: Register,
        steps: impl Fn(&mut Image) -> &mut Vec<Step>,
    ) -> Option<usize> {
        if guard == Register::TRUE {
            return None;
        }
        let unless = self.layouts.slot(guard);
        let at = steps(self.image).len();
        steps(self.image).push(Step::Skip { unless, target: 0 });
        self.image
            .debug
            .step_locations
            .resize(self.image.steps.len(), crate::flat_net::NO_NODE);
        Some(at)
    }

    fn step(&mut self, step: Step, node: u32) {
        self.image.steps.push(step);
        self.image.debug.step_locations.push(node);
    }

    fn op(&mut self, op: Op) {
        let at = index(self.image.code.len());
        let step = match op.kind {
            OpKind::Run(prim, form) => {
                self.words(prim, form, self.flat.words(op));
                let prim = self.prim(prim);
                Step::Run {
                    prim,
                    form,
                    start: at,
                    len: op.len,
                }
            }
            OpKind::Copy => {
                let words = self.flat.words(op);
                self.copy_pairs(Register(words[0]), Register(words[1]));
                let len = index(self.image.code.len()) - at;
                Step::Copy { at, len }
            }
            OpKind::Actuate(number, inputs) => self.actuate(number, inputs, self.flat.words(op)),
            OpKind::Call(number, inputs) => self.call(number, inputs, self.flat.words(op)),
        };
        // A row must not extend across the end of a skip.
        let last = self.image.steps.get_mut(self.merge_start..);
        if !(self.merges_rows && try_merge(last.and_then(<[Step]>::last_mut), step)) {
            self.step(step, op.node);
        }
    }

    fn actuate(&mut self, number: u32, inputs: u32, words: &[u32]) -> Step {
        let table = &self.flat.tables.actuators[number as usize];
        let (inputs, answers) = words.split_at(inputs as usize);
        let answers = table.answers.iter().zip(answers);
        let actuator = ActuatorPort {
            port: table.port.clone(),
            inputs: inputs.iter().map(|s| self.cells(Register(*s))).collect(),
            responses: answers
                .map(|(a, s)| (*a, self.layouts.slot(Register(*s))))
                .collect(),
        };
        self.image.actuators.push(actuator);
        let actuator = index(self.image.actuators.len() - 1);
        Step::Actuate { actuator }
    }

    fn call(&mut self, number: u32, inputs: u32, words: &[u32]) -> Step {
        let table = &self.flat.tables.functions[number as usize];
        let (arguments, results) = words.split_at(inputs as usize);
        let (results, found) = results.split_at(results.len() - usize::from(table.may_fail));
        let function = DeviceFunction {
            port: table.port.clone(),
            arguments: arguments.iter().map(|s| self.cells(Register(*s))).collect(),
            results: results.iter().map(|s| self.cells(Register(*s))).collect(),
            present: found
                .first()
                .map_or(TRUE, |s| self.layouts.slot(Register(*s))),
            work: table.work,
            external: table.external.clone(),
        };
        self.image.functions.push(function);
        let function = index(self.image.functions.len() - 1);
        Step::Call { function }
    }

    fn cells(&self, slot: Register) -> SlotRange {
        let (at, len) = (self.layouts.slot(slot), self.flat.registers.size(slot));
        SlotRange { start: at, len }
    }

    /// Appends the operand words of a primitive call to the code of the image, with registers replaced by memory slots.
    fn words(&mut self, prim: PrimId, form: Form, words: &[u32]) {
        let shape = self.flat.accesses.get(prim, form);
        let cell = |(word, access): (&u32, &Access)| match access {
            Access::Number => *word,
            _ => self.layouts.slot(Register(*word)),
        };
        self.image.code.extend(words.iter().zip(shape).map(cell));
    }

    fn copy_pairs(&mut self, from: Register, to: Register) {
        let (a, b) = (self.layouts.slot(from), self.layouts.slot(to));
        for k in 0..self.flat.registers.size(to) {
            self.image.code.extend([a + k, b + k]);
        }
    }

    fn prim(&mut self, prim: PrimId) -> u16 {
        let table = &mut self.image.prims_used;
        *self.prims.entry(prim).or_insert_with(|| {
            let desc = prim.desc();
            table.push(PrimUse {
                name: desc.name.to_owned(),
                signature: prim_signature(desc),
            });
            // The registry has fewer than 2^16 primitives.
            (table.len() - 1) as u16
        })
    }

    /// Appends the commit steps, which copy values for the next cycle, for a scope and the scopes inside it. Returns
    /// true if there were any.
    fn commit(&mut self, id: ScopeId) -> bool {
        let flat = self.flat;
        let scope = &flat.scopes[id.index()];
        let before = self.image.commit.len();
        let skip = self.open_skip(scope.guard, |image| &mut image.commit);
        let mut any = false;
        for item in &scope.items {
            if let Item::Scope(inner) = item {
                any |= self.commit(*inner);
            }
        }
        let at = index(self.image.code.len());
        for (from, to) in &scope.latches {
            self.copy_pairs(*from, *to);
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

/// Sets the target of the jump step with index `skip` to the end of `steps`. Has no effect for `None`.
fn land(steps: &mut [Step], skip: Option<usize>) {
    let end = index(steps.len());
    if let Some(Step::Skip { target: to, .. }) = skip.and_then(|at| steps.get_mut(at)) {
        *to = end;
    }
}

/// Merges a step into the previous step `last` if both are calls of the same primitive in the same form, or both are
/// copies, and their operand words are adjacent. Returns whether the steps were merged.
fn try_merge(last: Option<&mut Step>, step: Step) -> bool {
    match (last, step) {
        (
            Some(Step::Run {
                prim,
                form,
                start: at,
                len,
            }),
            Step::Run {
                prim: p,
                form: f,
                start: next,
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
