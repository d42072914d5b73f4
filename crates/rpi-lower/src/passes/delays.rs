//! Passes on delays: initial values and direct reads.

use super::laws::{self, Law};
use super::order::ops;
use super::rename::{Renames, drop_ops};
use crate::flat::{Flat, Op, Work};
use crate::slots::{Region, Slot};
use rpi_image::State;
use rpi_image::image::{End, Form};
use rpi_prims::{Clock, PrimId};
use rustc_hash::FxHashMap;

/// Moves a constant first value into the initial content of its delay.
///
/// `first ? k : pre x` and `null(pre x) ? k : pre x` of the reference system become a `pre x` with initial content `k`.
/// The choice selects the constant exactly in those cycles in which the delay still has its initial content.
pub(super) fn start(flat: &mut Flat, _: Clock) {
    let known = Known::new(flat);
    let mut renames = Renames::new(flat);
    let mut dropped = vec![false; flat.ops.len()];
    let mut started: FxHashMap<Slot, Slot> = FxHashMap::default();
    for (number, _) in ops(flat) {
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
        let mut content = Vec::new();
        flat.slots.content(choice.constant, &mut content);
        flat.slots.start(kept, &content);
        let written: Vec<Slot> = flat.writes(op).collect();
        renames.set(written[0], choice.delayed);
        if let Some(presence) = written.get(1) {
            renames.set(*presence, Slot::TRUE);
        }
        dropped[number as usize] = true;
    }
    renames.apply(flat);
    drop_ops(flat, &dropped);
}

/// Reads delayed values directly from the state if only operations read them. All operations run before the commit
/// phase overwrites the state.
pub(super) fn direct(flat: &mut Flat, _: Clock) {
    let read_late = read_late(flat);
    let mut renames = Renames::new(flat);
    let mut dropped = vec![false; flat.ops.len()];
    for (number, _) in ops(flat) {
        let op = flat.ops[number as usize];
        if let Some((kept, given)) = delay(flat, op)
            && !read_late[given.index()]
        {
            renames.set(given, kept);
            dropped[number as usize] = true;
        }
    }
    renames.apply(flat);
    drop_ops(flat, &dropped);
}

/// For each register, whether it is read outside operations: after the evaluation, by guards (in both phases) or by
/// resets.
pub(super) fn read_late(flat: &Flat) -> Vec<bool> {
    let mut late = vec![false; flat.slots.len()];
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
        End::Results(results) => results.iter().map(|r| r.condition).collect(),
        End::Ports { terminate, fail } => terminate.iter().chain(fail).copied().collect(),
    };
    for signal in exports.chain(ends) {
        late[signal.at as usize] = true;
        late[signal.present as usize] = true;
    }
    late
}

/// The registers (state, output) of a delay's copy.
fn delay(flat: &Flat, op: Op) -> Option<(Slot, Slot)> {
    let words = flat.words(op);
    let (from, to) = (Slot(*words.first()?), Slot(*words.get(1)?));
    let kept = matches!(flat.slots.region(from), Region::State(_));
    (op.work == Work::Copy && kept).then_some((from, to))
}

/// A choice between a constant and a delayed value.
struct Choice {
    delayed: Slot,
    constant: Slot,
}

/// Facts about registers, valid until the net is changed.
struct Known {
    /// For each register that is the output of a delay, the state register of the delay.
    kept: Vec<Option<Slot>>,
    /// The source of each latched register.
    latched: FxHashMap<Slot, Slot>,
    /// For each register computed by a negation, the negated register.
    opposite: FxHashMap<Slot, Slot>,
    /// For each register, whether it is read other than as the alternative to a constant in a choice that depends on
    /// `first`.
    read_plainly: Vec<bool>,
}

impl Known {
    fn new(flat: &Flat) -> Self {
        let mut known = Known {
            kept: vec![None; flat.slots.len()],
            latched: FxHashMap::default(),
            opposite: FxHashMap::default(),
            read_plainly: read_late(flat),
        };
        for scope in &flat.scopes {
            known
                .latched
                .extend(scope.latches.iter().map(|l| (l.1, l.0)));
        }
        let order = ops(flat);
        for &(number, _) in &order {
            let op = flat.ops[number as usize];
            if let Some((kept, given)) = delay(flat, op) {
                known.kept[given.index()] = Some(kept);
            }
            if let Work::Run(prim, Form::Total) = op.work
                && laws::of(prim) == Some(Law::Opposite)
            {
                let words = flat.words(op);
                known.opposite.insert(Slot(words[1]), Slot(words[0]));
            }
        }
        for &(number, _) in &order {
            let op = flat.ops[number as usize];
            let behind = known.behind_first(flat, op).map(|c| c.delayed);
            for slot in flat.reads(op).filter(|s| Some(*s) != behind) {
                known.read_plainly[slot.index()] = true;
            }
        }
        known
    }

    fn kept_of(&self, given: Slot) -> Option<Slot> {
        self.kept[given.index()]
    }

    fn choice(&self, flat: &Flat, op: Op) -> Option<Choice> {
        let sure = |c: &Choice| !self.read_plainly[c.delayed.index()];
        self.behind_first(flat, op)
            .filter(sure)
            .or_else(|| self.behind_null(flat, op))
    }

    /// Matches `first ? k : pre x`. Valid only if the `pre` has no other reader, which would see the changed initial
    /// content.
    fn behind_first(&self, flat: &Flat, op: Op) -> Option<Choice> {
        let Work::Run(prim, Form::Total) = op.work else {
            return None;
        };
        let (condition, choice) = self.alternative(flat, op, prim, [0, 1, 2])?;
        let first = self.kept_of(condition)?;
        let kept = self.kept_of(choice.delayed)?;
        let mut content = Vec::new();
        flat.slots.content(first, &mut content);
        let is_first = content == [1] && self.latched.get(&first) == Some(&Slot::FALSE);
        let alike = first != kept && flat.slots.region(first) == flat.slots.region(kept);
        (is_first && alike).then_some(choice)
    }

    /// Matches `null(pre x) ? k : pre x` for an x that is always present: the `pre` is absent exactly while it has its
    /// initial content.
    fn behind_null(&self, flat: &Flat, op: Op) -> Option<Choice> {
        let Work::Run(prim, Form::Optional) = op.work else {
            return None;
        };
        let (condition, choice) = self.alternative(flat, op, prim, [0, 2, 4])?;
        let words = flat.words(op);
        let (sure, other, present) = (Slot(words[1]), Slot(words[3]), Slot(words[5]));
        let was = self.kept_of(present)?;
        let null = self.opposite.get(&condition) == Some(&present);
        let total = self.latched.get(&was) == Some(&Slot::TRUE);
        (sure == Slot::TRUE && other == Slot::TRUE && null && total).then_some(choice)
    }

    /// Matches a choice between a constant and a delay; `at` are the word indices of condition, constant and delay.
    fn alternative(
        &self,
        flat: &Flat,
        op: Op,
        prim: PrimId,
        at: [usize; 3],
    ) -> Option<(Slot, Choice)> {
        let stateless = matches!(prim.desc().state, State::None);
        if laws::of(prim) != Some(Law::Choice) || !stateless {
            return None;
        }
        let [condition, constant, delayed] = at.map(|k| Slot(flat.words(op)[k]));
        let fits =
            flat.slots.region(constant) == Region::Constant && self.kept_of(delayed).is_some();
        fits.then_some((condition, Choice { delayed, constant }))
    }
}
