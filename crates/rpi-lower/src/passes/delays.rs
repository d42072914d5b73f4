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

/// Moves a constant first value into the initial content of its delay.
///
/// `first ? k : pre x` and `null(pre x) ? k : pre x` of the reference system become a `pre x` with initial content `k`.
/// The choice selects the constant exactly in those cycles in which the delay still has its initial content.
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

/// Removes the copies from the state of delays to their outputs where only operations read the outputs. These then read
/// the state itself, which the commit phase overwrites only after all operations have run.
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

/// For each register, whether anything but operations reads it: tables of the image, guards or resets.
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

/// The registers (state, output) of the copy with which a delay outputs its state; `None` for other operations.
fn delay(flat: &FlatNet, op: Op) -> Option<(Register, Register)> {
    let words = flat.words(op);
    let (from, to) = (Register(*words.first()?), Register(*words.get(1)?));
    let kept = matches!(flat.registers.region(from), Region::State(_));
    (op.kind == OpKind::Copy && kept).then_some((from, to))
}

/// Gives one register the initial content of another.
fn copy_initial(flat: &mut FlatNet, from: Register, to: Register) {
    let mut content = Vec::new();
    flat.registers.append_initial(from, &mut content);
    flat.registers.set_initial(to, &content);
}

/// A choice between a constant and a delayed value.
struct InitialChoice {
    delayed: Register,
    constant: Register,
}

/// Facts about the registers around delays, valid until the net is changed.
struct DelayFacts {
    /// For each register that is the output of a delay, the state register of the delay.
    state_of: Vec<Option<Register>>,
    /// For each register that keeps a value for the next cycle, the register that it copies.
    latched: FxHashMap<Register, Register>,
    /// For each register computed by a negation, the negated register.
    negated: FxHashMap<Register, Register>,
    /// For each register, whether it is read other than as the alternative to a constant in a choice that depends on
    /// `first`.
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

    /// Matches an operation of the form `first ? k : pre x`. Valid only if the `pre` has no other reader, which would
    /// see the changed initial content.
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

    /// Matches an operation of the form `null(pre x) ? k : pre x` for an x that is always present: the `pre` is absent
    /// exactly while it has its initial content.
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

    /// Matches a choice between a constant and a delay; `at` are the word indices of condition, constant and delay.
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
