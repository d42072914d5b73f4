//! Checks of the two step lists: jumps, writers and the order of reads.

use super::{ErrorLocation, Scope, Verifier};
use crate::desc::PrimDesc;
use crate::external::{ExternalFunction, ExternalPort};
use crate::image::{Form, SlotRange, Step, TRUE};
use crate::operands::{Operand, group_words, operand_layout};
use alloc::vec::Vec;
use alloc::{format, vec};

/// Declaration of a primitive that an image uses, with the operand layout and the number of words per call for each of
/// its two forms.
pub(super) struct PrimLayout {
    pub desc: &'static PrimDesc,
    pub forms: [(Vec<Operand>, usize); 2],
}

impl PrimLayout {
    fn new(desc: &'static PrimDesc) -> Self {
        let form = |form| {
            let fields = operand_layout(desc, form);
            let words = group_words(&fields);
            (fields, words)
        };
        PrimLayout {
            desc,
            forms: [form(Form::Total), form(Form::Optional)],
        }
    }
}

impl Verifier<'_> {
    /// Checks the steps of the evaluation phase in one pass, in order of execution. `prims` holds the declarations of
    /// [`Image::prims_used`](crate::image::Image::prims_used), `None` for an invalid one.
    pub(super) fn evaluation(&mut self, prims: &[Option<&'static PrimDesc>]) {
        let known: Vec<Option<PrimLayout>> = prims.iter().map(|p| p.map(PrimLayout::new)).collect();
        let mut used = UsedPorts::new(self.image.actuators.len(), self.image.functions.len());
        let mut ends = Vec::new();
        for (pc, step) in self.image.steps.iter().enumerate() {
            self.location = ErrorLocation::Step(pc);
            self.leave_skips(&mut ends, pc);
            match *step {
                Step::Run {
                    prim,
                    form,
                    start: at,
                    len,
                } => self.run(&known, prim, form, SlotRange { start: at, len }),
                Step::Copy { at, len } => self.check_copies(SlotRange { start: at, len }),
                Step::Skip { unless, target: to } => {
                    self.check_control_read(unless);
                    self.enter_skip(&mut ends, pc, to, unless, self.image.steps.len());
                }
                Step::Reset { unless, fragment } => {
                    self.check_control_read(unless);
                    let known = (fragment as usize) < self.image.fragments.len();
                    self.require(known, || format!("there is no fragment {fragment}"));
                }
                Step::Actuate { actuator } => self.actuate(actuator, &mut used),
                Step::Call { function } => self.call(function, &mut used),
            }
        }
        self.leave_skips(&mut ends, self.image.steps.len());
    }

    /// Checks the steps of the commit phase: they are only skips and copies, the copies write only state, and no copy
    /// reads a slot that an earlier copy has overwritten.
    pub(super) fn commit(&mut self) {
        let mut ends = Vec::new();
        let mut gone = vec![false; self.owned.len()];
        for (pc, step) in self.image.commit.iter().enumerate() {
            self.location = ErrorLocation::Commit(pc);
            self.leave_skips(&mut ends, pc);
            match *step {
                Step::Copy { at, len } => {
                    self.check_commit_copies(SlotRange { start: at, len }, &mut gone)
                }
                Step::Skip { unless, target: to } => {
                    self.check_commit_control_read(unless);
                    self.enter_skip(&mut ends, pc, to, unless, self.image.commit.len());
                }
                Step::Run { .. }
                | Step::Reset { .. }
                | Step::Actuate { .. }
                | Step::Call { .. } => {
                    self.report("only skips and copies are allowed in the commit phase".into());
                }
            }
        }
        self.leave_skips(&mut ends, self.image.commit.len());
    }

    fn enter_skip(&mut self, ends: &mut Vec<usize>, pc: usize, to: u32, guard: u32, len: usize) {
        let outer = ends.last().map_or(len, |e| *e);
        let to = to as usize;
        if to <= pc || to > outer {
            return self.report(format!(
                "skip to {to} must lie after {pc} and not beyond {outer}"
            ));
        }
        ends.push(to);
        if let Some(count) = self.open_guards.get_mut(guard as usize) {
            *count += 1;
        }
        let outer = core::mem::replace(&mut self.scope, self.scopes.len() as u32);
        let is_final = self.is_final(guard);
        self.scopes.push(Scope {
            outer,
            guard,
            is_final,
        });
    }

    /// Returns whether no later step changes the slot. Only state slots can change during the evaluation phase, and
    /// each has one writer.
    fn is_final(&self, cell: u32) -> bool {
        let layout = self.image.layout;
        let state = (layout.external..layout.state).contains(&cell);
        let place = cell.checked_sub(layout.external).map(|at| at as usize);
        !state || place.is_some_and(|at| self.owned.get(at).is_some_and(|owned| *owned))
    }

    fn leave_skips(&mut self, ends: &mut Vec<usize>, pc: usize) {
        while ends.pop_if(|end| *end <= pc).is_some() {
            let Scope { outer, guard, .. } = self.scopes[self.scope as usize];
            if let Some(count) = self.open_guards.get_mut(guard as usize) {
                *count -= 1;
            }
            self.scope = outer;
        }
    }

    fn check_copies(&mut self, words: SlotRange) {
        let Some(words) = self.operand_words(words, 2) else {
            return;
        };
        for pair in words.chunks_exact(2) {
            self.check_read(SlotRange {
                start: pair[0],
                len: 1,
            });
            self.check_write(SlotRange {
                start: pair[1],
                len: 1,
            });
        }
    }

    fn check_commit_copies(&mut self, words: SlotRange, gone: &mut [bool]) {
        let first = self.image.layout.external;
        let Some(words) = self.operand_words(words, 2) else {
            return;
        };
        for pair in words.chunks_exact(2) {
            let state = |cell: u32| cell.checked_sub(first).map(|k| k as usize);
            self.check_read(SlotRange {
                start: pair[0],
                len: 1,
            });
            let stale = state(pair[0]).and_then(|k| gone.get(k)) == Some(&true);
            self.require(!stale, || {
                format!("slot {} was overwritten by an earlier copy", pair[0])
            });
            self.check_state_write(SlotRange {
                start: pair[1],
                len: 1,
            });
            if let Some(flag) = state(pair[1]).and_then(|k| gone.get_mut(k)) {
                *flag = true;
            }
        }
    }

    fn actuate(&mut self, actuator: u32, used: &mut UsedPorts) {
        let Some(a) = self.image.actuators.get(actuator as usize) else {
            return self.report(format!("there is no actuator {actuator}"));
        };
        self.require(UsedPorts::mark_used(&mut used.actuators, actuator), || {
            "actuator port is set twice".into()
        });
        a.inputs.iter().for_each(|c| self.check_read(*c));
        a.responses
            .iter()
            .for_each(|(_, at)| self.check_write(SlotRange { start: *at, len: 1 }));
    }

    fn call(&mut self, function: u32, used: &mut UsedPorts) {
        let Some(f) = self.image.functions.get(function as usize) else {
            return self.report(format!("there is no function {function}"));
        };
        self.require(UsedPorts::mark_used(&mut used.functions, function), || {
            "device function is called twice".into()
        });
        if let Some(external) = &f.external {
            let fits = external.is_valid()
                && has_lengths(&f.arguments, &external.inputs)
                && has_lengths(&f.results, &external.outputs);
            self.require(fits, || "values of an external function do not fit".into());
        }
        f.arguments.iter().for_each(|c| self.check_read(*c));
        f.results.iter().for_each(|c| self.check_write(*c));
        if f.present != TRUE {
            self.check_write(SlotRange {
                start: f.present,
                len: 1,
            });
        }
    }
}

/// Returns whether ranges have the lengths of the groups of values of ports.
fn has_lengths(ranges: &[SlotRange], ports: &[ExternalPort]) -> bool {
    let lens = ExternalFunction::group_lens(ports).map(|(_, len)| len);
    lens.eq(ranges.iter().map(|r| r.len))
}

/// For each actuator port and each device function of an image, whether a step has already used it. A second use is an
/// error.
struct UsedPorts {
    actuators: Vec<bool>,
    functions: Vec<bool>,
}

impl UsedPorts {
    fn new(actuators: usize, functions: usize) -> Self {
        UsedPorts {
            actuators: vec![false; actuators],
            functions: vec![false; functions],
        }
    }

    /// Marks the entry with this index as used. Returns true for its first use, and false for a further use or an index
    /// out of range.
    fn mark_used(flags: &mut [bool], index: u32) -> bool {
        let flag = flags.get_mut(index as usize);
        flag.is_some_and(|f| !core::mem::replace(f, true))
    }
}
