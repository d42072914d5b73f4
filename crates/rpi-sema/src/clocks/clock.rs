//! Clocks during inference: a tree of samplings whose root is the base clock of the unit.

use crate::hash::{FastMap, FastSet};
use crate::typed::{ExprId, FlowId};

/// Clock condition: the flow whose value decides in which cycles a clock ticks.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum ClockCondition {
    /// Flow of the unit.
    Flow(FlowId),
    /// Condition inside a call, without a name in the caller: the call expression and the index in
    /// [`Clocks::exposed`](super::Clocks::exposed) of the called unit.
    CallInternal(ExprId, u32),
}

/// Sampling of a flow: a clock condition, and the value of it for which the sampled flow has a value.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Sampling {
    /// Condition of the sampling.
    pub condition: ClockCondition,
    /// Value of the condition in the cycles that count: 0 or 1 for a Boolean, the index of an enum's value.
    pub value: u32,
}

/// Clock of a leaf during inference: any clock, the base clock, or one sampling. The parent of a sampling is the clock
/// of its condition.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(super) struct Clock(u32);

impl Clock {
    /// Clock of a constant, compatible with every clock. Also the initial value during inference.
    pub(super) const ANY: Clock = Clock(u32::MAX);
    /// Base clock: all cycles of the unit.
    pub(super) const BASE: Clock = Clock(0);

    /// Returns the clock of sampling number `number` of [`Ticks`].
    pub(super) fn from_sampling(number: usize) -> Clock {
        Clock(u32::try_from(number + 1).unwrap_or(u32::MAX - 1))
    }

    /// Returns the number of the clock's sampling; none for [`Clock::ANY`] and [`Clock::BASE`].
    pub(super) fn sampling(self) -> Option<usize> {
        let sampled = self != Clock::ANY && self != Clock::BASE;
        sampled.then(|| self.0 as usize - 1)
    }
}

/// All samplings of a unit, each stored once.
#[derive(Debug, Default)]
pub(super) struct Samplings {
    all: Vec<Sampling>,
    clock_by_sampling: FastMap<Sampling, Clock>,
    conditions: FastSet<ClockCondition>,
}

impl Samplings {
    /// Returns the clock of a sampling, adding the sampling if it is new.
    pub(super) fn intern(&mut self, tick: Sampling) -> Clock {
        let next = Clock::from_sampling(self.all.len());
        let (all, conditions) = (&mut self.all, &mut self.conditions);
        *self.clock_by_sampling.entry(tick).or_insert_with(|| {
            all.push(tick);
            conditions.insert(tick.condition);
            next
        })
    }

    /// Returns the sampling of a clock; none for [`Clock::ANY`] and [`Clock::BASE`].
    pub(super) fn sampling(&self, clock: Clock) -> Option<Sampling> {
        self.all.get(clock.sampling()?).copied()
    }

    /// Returns the clock of a sampling that has been added before.
    pub(super) fn clock_of(&self, tick: Sampling) -> Option<Clock> {
        self.clock_by_sampling.get(&tick).copied()
    }

    /// Returns whether a sampling with this condition exists.
    pub(super) fn is_clock_condition(&self, by: ClockCondition) -> bool {
        self.conditions.contains(&by)
    }

    /// Number of samplings.
    pub(super) fn len(&self) -> usize {
        self.all.len()
    }
}
