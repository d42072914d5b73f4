//! Phases of a fragment: its first cycles one by one, and all later cycles together. Relates the phases of a fragment
//! to those of its parent.

use crate::init::abstract_value::AbstractValue;

/// Number of phases into which the run of a fragment is divided: one for each of its first cycles, and one for all
/// later cycles.
pub(super) const PHASES: usize = 5;

/// Index of the last phase, which covers all later cycles.
pub(super) const LAST_PHASE: usize = PHASES - 1;

/// One value for each phase of a fragment: for each of its first cycles, and for all later cycles together.
pub(super) type PerPhase<T> = [T; PHASES];

/// Set of phases of a fragment, one bit for each phase.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct PhaseSet(u8);

impl PhaseSet {
    pub(super) fn single(phase: usize) -> PhaseSet {
        PhaseSet(1 << phase)
    }

    pub(super) fn union(self, other: PhaseSet) -> PhaseSet {
        PhaseSet(self.0 | other.0)
    }

    pub(super) fn intersection(self, other: PhaseSet) -> PhaseSet {
        PhaseSet(self.0 & other.0)
    }

    /// Returns the set of all phases that are not in this set.
    pub(super) fn complement(self) -> PhaseSet {
        PhaseSet(!self.0 & ((1 << PHASES) - 1))
    }

    pub(super) fn intersects(self, other: PhaseSet) -> bool {
        self.0 & other.0 != 0
    }

    pub(super) fn is_empty(self) -> bool {
        self.0 == 0
    }

    pub(super) fn contains(self, phase: usize) -> bool {
        self.intersects(PhaseSet::single(phase))
    }

    pub(super) fn phases(self) -> impl DoubleEndedIterator<Item = usize> {
        (0..PHASES).filter(move |phase| self.contains(*phase))
    }
}

/// Whether a fragment is active in one phase of its parent: never, always or possibly.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Activity {
    Never,
    Maybe,
    Always,
}

impl Activity {
    /// Returns the activity of a fragment whose activation condition has this abstract value.
    pub(super) fn from_condition(condition: &AbstractValue) -> Activity {
        match (condition, condition.truth()) {
            (AbstractValue::Unreachable, _) | (_, Some(false)) => Activity::Never,
            (_, Some(true)) => Activity::Always,
            _ => Activity::Maybe,
        }
    }
}

/// Returns for each phase of a fragment the phases in which its parent can be at that time. `active` is the activity of
/// the fragment in each phase of its parent, `restarts` whether it can restart, and `activated` whether it has an
/// activation condition.
pub(super) fn parent_phases(
    active: &PerPhase<Activity>,
    restarts: bool,
    activated: bool,
) -> PerPhase<PhaseSet> {
    let mut sets = [PhaseSet::default(); PHASES];
    if !activated && !restarts {
        return std::array::from_fn(PhaseSet::single);
    }
    for phase in 0..PHASES {
        let before = match phase {
            0 => None,
            _ => Some(sets[phase - 1]),
        };
        sets[phase] = next_parent_phases(active, before, restarts || phase == LAST_PHASE);
    }
    sets
}

/// Returns the phases of the parent in which a fragment can be in its next phase. `before` are the parent's phases for
/// the previous phase; `None` for the first phase. `endless` is whether the phase can begin at any later time.
fn next_parent_phases(
    active: &PerPhase<Activity>,
    before: Option<PhaseSet>,
    endless: bool,
) -> PhaseSet {
    let mut set = PhaseSet::default();
    let (from, settled) = match before {
        None => (0, 0),
        Some(before) => {
            let mut phases = before.phases();
            let Some(first) = phases.next() else {
                return set;
            };
            let last = phases.next_back().unwrap_or(first);
            (after(first), after(last))
        }
    };
    for (phase, active) in active.iter().enumerate().skip(from) {
        if *active == Activity::Never {
            continue;
        }
        set = set.union(PhaseSet::single(phase));
        if *active == Activity::Always && phase >= settled && !endless {
            break;
        }
    }
    set
}

fn after(phase: usize) -> usize {
    (phase + 1).min(LAST_PHASE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(set: PhaseSet) -> Vec<usize> {
        set.phases().collect()
    }

    #[test]
    fn a_fragment_that_starts_later_has_its_first_phase_later() {
        use Activity::{Always, Maybe, Never};
        let sets = parent_phases(&[Never, Always, Maybe, Maybe, Maybe], false, true);
        assert_eq!(shown(sets[0]), [1]);
        assert_eq!(shown(sets[1]), [2, 3, 4]);
    }

    #[test]
    fn a_fragment_that_restarts_can_be_in_its_first_phase_at_any_time() {
        let sets = parent_phases(&[Activity::Always; PHASES], true, true);
        assert_eq!(shown(sets[0]), [0, 1, 2, 3, 4]);
        assert_eq!(shown(sets[1]), [1, 2, 3, 4]);
    }

    #[test]
    fn a_fragment_that_is_always_active_goes_with_its_parent() {
        let sets = parent_phases(&[Activity::Always; PHASES], false, true);
        assert!((0..LAST_PHASE).all(|phase| shown(sets[phase]) == [phase]));
    }
}
