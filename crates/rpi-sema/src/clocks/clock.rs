//! Clocks while they are being worked out: a tree of samplings that grows from all cycles of the unit.

use crate::hash::{Map, Set};
use crate::typed::{ExprId, FlowId};

/// What decides whether a clock ticks.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum Decider {
    /// A flow of the unit.
    Flow(FlowId),
    /// What decides about results of a call and has no name in the unit: the entry of this number in the list
    /// [`Clocks::exposed`](super::Clocks::exposed) of the called unit.
    Inside(ExprId, u32),
}

/// One sampling: the cycles in which what decides has this value.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Tick {
    /// What decides.
    pub by: Decider,
    /// The value: 0 or 1 for a Boolean, the place of an enum's value.
    pub value: u32,
}

/// A clock: every clock, all cycles of the unit, or one sampling, whose parent is the clock of what decides.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(super) struct Clock(u32);

impl Clock {
    /// That of a constant, which fits every clock; also what is not known yet.
    pub(super) const ANY: Clock = Clock(u32::MAX);
    /// All cycles of the unit.
    pub(super) const BASE: Clock = Clock(0);

    /// The clock of the sampling of this number.
    pub(super) fn numbered(number: usize) -> Clock {
        Clock(u32::try_from(number + 1).unwrap_or(u32::MAX - 1))
    }

    /// The number of its sampling.
    pub(super) fn sampling(self) -> Option<usize> {
        let sampled = self != Clock::ANY && self != Clock::BASE;
        sampled.then(|| self.0 as usize - 1)
    }
}

/// All samplings of a unit.
#[derive(Debug, Default)]
pub(super) struct Ticks {
    all: Vec<Tick>,
    known: Map<Tick, Clock>,
    deciders: Set<Decider>,
}

impl Ticks {
    /// The clock that a sampling makes.
    pub(super) fn clock(&mut self, tick: Tick) -> Clock {
        let next = Clock::numbered(self.all.len());
        let (all, deciders) = (&mut self.all, &mut self.deciders);
        *self.known.entry(tick).or_insert_with(|| {
            all.push(tick);
            deciders.insert(tick.by);
            next
        })
    }

    /// The sampling of a clock.
    pub(super) fn tick(&self, clock: Clock) -> Option<Tick> {
        self.all.get(clock.sampling()?).copied()
    }

    /// The clock of a sampling that is known.
    pub(super) fn clock_of(&self, tick: Tick) -> Option<Clock> {
        self.known.get(&tick).copied()
    }

    /// Whether something is sampled by this.
    pub(super) fn has(&self, by: Decider) -> bool {
        self.deciders.contains(&by)
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.all.len()
    }
}
