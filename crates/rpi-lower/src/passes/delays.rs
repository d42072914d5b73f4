//! Passes on delays: initial values and direct reads.

use super::identities::{self, Identity};
use super::substitution::{Substitution, drop_ops};
use super::traversal::ops_in_order;
use crate::flat_net::{FlatNet, Op, OpKind};
use crate::registers::{Region, Register};
use rpi_image::StateSize;
use rpi_image::image::{CommandEnd, Form};
use rpi_prims::{CycleTime, PrimId};
use rustc_hash::FxHashMap;

/// Turns a constant first value of a delay into the initial content of its state.
///
/// In imported nets, a first value `k` has the form `first ? k : pre x` or `null(pre x) ? k : pre x`. Both become a
/// `pre x` with initial content `k`, because the choice selects the constant exactly in those cycles in which the delay
/// still has its initial content.
pub(super) fn fold_initial_values(flat: &mut FlatNet, _: CycleTime) {
    let known = DelayFacts::new(flat);
    let mut renames = Substitution::new(flat);
    let mut dropped = vec![false; flat.ops.len()];
    let mut started: FxHashMap<Register, Register> = FxHashMap::default();
    for (number, _) in ops_in_order(flat) {
        let op = flat.ops[number as usize];
        let Some(choice) = known.choice(flat, op) else {
            continue;
        };
        let Some(kept) = known.kept_of(choice.delayed) else {
            continue;
        };
        if *started.entry(kept).or_insert(choice.constant) != choice.constant {
            continue;
        }
        copy_initial(flat, choice.constant, kept);
        let written: Vec<Register> = flat.writes(op).collect();
        renames.set(written[0], choice.delayed);
        if let Some(presence) = written.get(1) {
            renames.set(*presence, Register::TRUE);
        }
        dropped[number as usize] = true;
    }
    renames.apply(flat);
    drop_ops(flat, &dropped);
}

/// Removes the copy from the state of a delay to its output if only operations read the output. These operations then
/// read the state itself, which the commit phase overwrites only after all operations have run.
pub(super) fn read_state_directly(flat: &mut FlatNet, _: CycleTime) {
    let read_late = read_outside_ops(flat);
    let mut renames = Substitution::new(flat);
    let mut dropped = vec![false; flat.ops.len()];
    for (number, _) in ops_in_order(flat) {
        let op = flat.ops[number as usize];
        if let Some((kept, output)) = delay(flat, op)
            && !read_late[output.index()]
        {
            renames.set(output, kept);
            dropped[number as usize] = true;
        }
    }
    renames.apply(flat);
    drop_ops(flat, &dropped);
}

/// Returns, for each register, whether it is read other than by an operation: by an export, an end condition, a guard,
/// a reset or a copy at the end of the cycle.
pub(super) fn read_outside_ops(flat: &FlatNet) -> Vec<bool> {
    let mut late = vec![false; flat.registers.len()];
    for scope in &flat.scopes {
        let latched = scope.latches.iter().map(|l| l.0);
        let reset = scope.reset.map(|r| r.0);
        latched
            .chain(reset)
            .chain([scope.guard])
            .for_each(|s| late[s.index()] = true);
    }
    let exports = flat.tables.exports.iter().map(|e| e.value);
    let ends: Vec<_> = match &flat.tables.end {
        CommandEnd::Results(results) => results.iter().map(|r| r.condition).collect(),
        CommandEnd::Ports { terminate, fail } => terminate.iter().chain(fail).copied().collect(),
    };
    for signal in exports.chain(ends) {
        late[signal.start as usize] = true;
        late[signal.present as usize] = true;
    }
    late
}

/// Returns the registers (state, output) of the copy with which a delay outputs its state; `None` if the operation is
/// not such a copy.
fn delay(flat: &FlatNet, op: Op) -> Option<(Register, Register)> {
    let words = flat.words(op);
    let (from, to) = (Register(*words.first()?), Register(*words.get(1)?));
    let kept = matches!(flat.registers.region(from), Region::State(_));
    (op.kind == OpKind::Copy && kept).then_some((from, to))
}

/// Gives the register `to` the initial content of the register `from`.
fn copy_initial(flat: &mut FlatNet, from: Register, to: Register) {
    let mut content = Vec::new();
    flat.registers.append_initial(from, &mut content);
    flat.registers.set_initial(to, &content);
}

/// Choice between a constant, in the first cycle, and the output of a delay, in all later ones.
struct InitialChoice {
    delayed: Register,
    constant: Register,
}

/// Facts about the registers around delays, valid for the net from which they were computed.
struct DelayFacts {
    /// For each register, the state register of the delay whose output it is; `None` for all other registers.
    state_of: Vec<Option<Register>>,
    /// For each register that receives a value at the end of the cycle for the next one, the register that is copied
    /// into it.
    latched: FxHashMap<Register, Register>,
    /// For each register computed by a negation, the operand of the negation.
    negated: FxHashMap<Register, Register>,
    /// For each register, whether it has a reader that is not a choice of the form `first ? constant : register`.
    has_other_readers: Vec<bool>,
}

impl DelayFacts {
    fn new(flat: &FlatNet) -> Self {
        let mut known = DelayFacts {
            state_of: vec![None; flat.registers.len()],
            latched: FxHashMap::default(),
            negated: FxHashMap::default(),
            has_other_readers: read_outside_ops(flat),
        };
        for scope in &flat.scopes {
            known
                .latched
                .extend(scope.latches.iter().map(|l| (l.1, l.0)));
        }
        let order = ops_in_order(flat);
        for &(number, _) in &order {
            let op = flat.ops[number as usize];
            if let Some((kept, output)) = delay(flat, op) {
                known.state_of[output.index()] = Some(kept);
            }
            if let OpKind::Run(prim, Form::Total) = op.kind
                && identities::identity_of(prim) == Some(Identity::Negation)
            {
                let words = flat.words(op);
                known.negated.insert(Register(words[1]), Register(words[0]));
            }
        }
        for &(number, _) in &order {
            let op = flat.ops[number as usize];
            let behind = known.behind_first(flat, op).map(|c| c.delayed);
            for slot in flat.reads(op).filter(|s| Some(*s) != behind) {
                known.has_other_readers[slot.index()] = true;
            }
        }
        known
    }

    fn kept_of(&self, output: Register) -> Option<Register> {
        self.state_of[output.index()]
    }

    fn choice(&self, flat: &FlatNet, op: Op) -> Option<InitialChoice> {
        let sure = |c: &InitialChoice| !self.has_other_readers[c.delayed.index()];
        self.behind_first(flat, op)
            .filter(sure)
            .or_else(|| self.behind_null(flat, op))
    }

    /// Returns the parts of an operation of the form `first ? k : pre x`; `None` for all other operations. The choice
    /// may be replaced only if the `pre` has no other reader, which would see the changed initial content.
    fn behind_first(&self, flat: &FlatNet, op: Op) -> Option<InitialChoice> {
        let OpKind::Run(prim, Form::Total) = op.kind else {
            return None;
        };
        let (condition, choice) = self.alternative(flat, op, prim, [0, 1, 2])?;
        let first = self.kept_of(condition)?;
        let kept = self.kept_of(choice.delayed)?;
        let mut content = Vec::new();
        flat.registers.append_initial(first, &mut content);
        let is_first = content == [1] && self.latched.get(&first) == Some(&Register::FALSE);
        let alike = first != kept && flat.registers.region(first) == flat.registers.region(kept);
        (is_first && alike).then_some(choice)
    }

    /// Returns the parts of an operation of the form `null(pre x) ? k : pre x` with an x that is always present; `None`
    /// for all other operations. Such a `pre` is absent exactly while it has its initial content.
    fn behind_null(&self, flat: &FlatNet, op: Op) -> Option<InitialChoice> {
        let OpKind::Run(prim, Form::Optional) = op.kind else {
            return None;
        };
        let (condition, choice) = self.alternative(flat, op, prim, [0, 2, 4])?;
        let words = flat.words(op);
        let (sure, other, present) = (Register(words[1]), Register(words[3]), Register(words[5]));
        let was = self.kept_of(present)?;
        let null = self.negated.get(&condition) == Some(&present);
        let total = self.latched.get(&was) == Some(&Register::TRUE);
        (sure == Register::TRUE && other == Register::TRUE && null && total).then_some(choice)
    }

    /// Returns the condition and the alternatives of a choice between a constant and the output of a delay; `None` for
    /// all other operations. `at` has the indices of the operand words of condition, constant and delay.
    fn alternative(
        &self,
        flat: &FlatNet,
        op: Op,
        prim: PrimId,
        at: [usize; 3],
    ) -> Option<(Register, InitialChoice)> {
        let stateless = matches!(prim.desc().state, StateSize::None);
        if identities::identity_of(prim) != Some(Identity::Choice) || !stateless {
            return None;
        }
        let [condition, constant, delayed] = at.map(|k| Register(flat.words(op)[k]));
        let is_initial_choice =
            flat.registers.region(constant) == Region::Constant && self.kept_of(delayed).is_some();
        is_initial_choice.then_some((condition, InitialChoice { delayed, constant }))
    }
}
