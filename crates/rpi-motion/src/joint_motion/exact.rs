//! Set-points that are chosen from outside, where the limits and the ranges allow it.

use super::{JointGoal, JointMotion};
use crate::JointState;
use rpi_kin::MAX_AXES;
use rpi_kin::state_to_rest::AxisState;

impl JointMotion {
    /// Makes plans use this share of the jerk that they would use otherwise, until the next motion begins.
    pub(crate) fn scale_jerk(&mut self, share: f64) {
        self.bounds
            .iter_mut()
            .for_each(|bounds| bounds.jerk *= share);
    }

    /// Returns the state of the next cycle: for each axis that of the first of `candidates` that keeps its limits, and from which
    /// it can stop within its range; without one, as [`next_set_point`](Self::next_set_point) with the goal `goal`.
    /// `keeps_limits` tells whether an axis, counted from 0, keeps this share of its limits if it moves to a position (rad).
    ///
    /// A plan to a goal that is very near ends at the goal after a jump by its tolerance, which may exceed the jerk: then the axis
    /// takes the plan of its stop.
    pub(crate) fn next_of(
        &mut self,
        candidates: &[JointState],
        goal: &JointGoal,
        keeps_limits: impl Fn(usize, f64, Share) -> bool,
    ) -> JointState {
        let mut next: [Option<AxisState>; MAX_AXES] = [None; MAX_AXES];
        for candidate in candidates.iter().map(JointState::to_axes) {
            let fits =
                |axis: &usize| keeps_limits(*axis, candidate[*axis].position, Share::Planned);
            let is_open = |axis: &usize| next[*axis].is_none();
            if !(0..self.arm.axes()).filter(is_open).any(|axis| fits(&axis)) {
                continue;
            }
            let can_stop = self.can_stop_from(&candidate);
            for axis in (0..self.arm.axes()).filter(fits) {
                next[axis] = next[axis].or(can_stop[axis].then_some(candidate[axis]));
            }
        }
        if next[..self.arm.axes()].iter().any(Option::is_none) {
            let goal = self.limited(goal, 1.0);
            let stop = self.stop_from(&self.state);
            let stopping = stop.map_or(self.state, |stop| stop.state_at(self.period));
            let planned = self.planned(&goal, &self.limits(&goal, 1.0));
            for (axis, next) in next.iter_mut().enumerate().take(self.arm.axes()) {
                let keeps = keeps_limits(axis, planned[axis].position, Share::Whole);
                let other = if keeps { planned[axis] } else { stopping[axis] };
                *next = next.or(Some(other));
            }
        }
        let next = core::array::from_fn(|axis| next[axis].unwrap_or(self.state[axis]));
        self.previous = core::mem::replace(&mut self.state, next);
        JointState::from_axes(&next)
    }
}

/// Share of the limits of an axis that a set-point may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Share {
    /// The share that plans use.
    Planned,
    /// The limits themselves.
    Whole,
}
