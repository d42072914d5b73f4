//! Clocks during inference: a tree of samplings whose root is the base clock of the unit.

use crate::hash::{FastMap, FastSet};
use crate::typed::{ExprId, FlowId};

/// Clock condition: a flow whose value decides in which cycles a clock ticks.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum ClockCondition {
    /// Flow of the unit itself.
    Flow(FlowId),
    /// Condition inside of a call that has no name in the caller: the call expression, and the index of the condition
    /// in [`Clocks::exposed`](super::Clocks::exposed) of the called unit.
    CallInternal(ExprId, u32),
}

/// Sampling of a flow: a clock condition, and its value in the cycles in which the sampled flow has a value.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Sampling {
    /// Flow whose value decides when the sampled flow has a value.
    pub condition: ClockCondition,
    /// Value of the condition in the cycles in which the sampled flow has a value: 0 or 1 for a Boolean, an index for
    /// an enum.
    pub value: u32,
}

/// Clock of a leaf (scalar part) during inference: any clock, the base clock, or a sampling. A sampling is sampled from
/// its parent, the clock of its condition.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(super) struct Clock(u32);

impl Clock {
    /// Clock of a constant, which is compatible with every clock. It is also the initial value of every clock in the
    /// inference.
    pub(super) const ANY: Clock = Clock(u32::MAX);
    /// Base clock, which ticks in all cycles of the unit.
    pub(super) const BASE: Clock = Clock(0);

    /// Returns the clock of the sampling with this index in [`Samplings`].
    pub(super) fn from_sampling(number: usize) -> Clock {
        Clock(u32::try_from(number + 1).unwrap_or(u32::MAX - 1))
    }

    /// Returns the index of the clock's sampling in [`Samplings`]; `None` for [`Clock::ANY`] and [`Clock::BASE`].
    pub(super) fn sampling(self) -> Option<usize> {
        let sampled = self != Clock::ANY && self != Clock::BASE;
        sampled.then(|| self.0 as usize - 1)
    }
}

/// All samplings that occur in a unit, each stored once, so that a clock can be a mere index.
#[derive(Debug, Default)]
pub(super) struct Samplings {
    all: Vec<Sampling>,
    clock_by_sampling: FastMap<Sampling, Clock>,
    conditions: FastSet<ClockCondition>,
}

impl Samplings {
    /// Returns the clock of a sampling, and adds the sampling if it is new.
    pub(super) fn intern(&mut self, tick: Sampling) -> Clock {
        let next = Clock::from_sampling(self.all.len());
        let (all, conditions) = (&mut self.all, &mut self.conditions);
        *self.clock_by_sampling.entry(tick).or_insert_with(|| {
            all.push(tick);
            conditions.insert(tick.condition);
            next
        })
    }

    /// Returns the sampling of a clock; `None` for [`Clock::ANY`] and [`Clock::BASE`].
    pub(super) fn sampling(&self, clock: Clock) -> Option<Sampling> {
        self.all.get(clock.sampling()?).copied()
    }

    /// Returns the clock of a sampling; `None` if the sampling has not been added before.
    pub(super) fn clock_of(&self, tick: Sampling) -> Option<Clock> {
        self.clock_by_sampling.get(&tick).copied()
    }

    /// Whether any sampling has this condition.
    pub(super) fn is_clock_condition(&self, by: ClockCondition) -> bool {
        self.conditions.contains(&by)
    }

    /// Returns the number of different samplings in the unit.
    pub(super) fn len(&self) -> usize {
        self.all.len()
    }
}
