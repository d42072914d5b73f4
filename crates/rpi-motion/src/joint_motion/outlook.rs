//! Plans of the axes to targets, and when they pass a place on the way.

use super::{AT_REST, JointGoal, JointMotion};
use crate::online::{AxisLimits, MotionOptions, OnlineMotion, Synchronization};
use crate::passage::time_of_passage;
use crate::{JointState, Joints};
use rpi_kin::MAX_AXES;
use rpi_kin::state_to_rest::AxisState;

impl JointMotion {
    /// Plans the way to targets that move with their velocities, in coordinates that move with the targets; `None` if there
    /// is no plan.
    pub(super) fn plan_to(
        &self,
        target: &[AxisState; MAX_AXES],
        limits: &[AxisLimits; MAX_AXES],
        synchronization: Synchronization,
    ) -> Option<OnlineMotion<MAX_AXES>> {
        let options = MotionOptions {
            synchronization,
            minimum_duration: 0.0,
        };
        let relative = core::array::from_fn(|axis| AxisState {
            position: self.state[axis].position - target[axis].position,
            velocity: self.state[axis].velocity - target[axis].velocity,
            acceleration: self.state[axis].acceleration,
        });
        let limits = core::array::from_fn(|axis| AxisLimits {
            max_velocity: limits[axis].max_velocity - target[axis].velocity,
            min_velocity: limits[axis].min_velocity - target[axis].velocity,
            ..limits[axis]
        });
        OnlineMotion::to_position(&relative, &AT_REST, &limits, options).ok()
    }

    /// Returns the time (s) from the last set-point until `distance`, which does not decrease on the way to the joint
    /// positions `to` (rad), reaches `place`. The way is planned from the present state with the share `speed_share` (0 to
    /// 1) of the requested speed, as in the next cycle. `None` if there is no plan.
    #[must_use]
    pub fn time_until(
        &self,
        to: &Joints,
        speed_share: f64,
        distance: impl Fn(&JointState) -> f64,
        place: f64,
    ) -> Option<f64> {
        let goal = self.limited(&JointGoal::Position(*to), speed_share);
        if goal == JointGoal::Rest {
            return None;
        }
        let (target, limits) = (self.target(&goal), self.limits(&goal, speed_share));
        let plan = self.plan_to(&target, &limits, Synchronization::Time)?;
        let at = |time: f64| distance(&JointState::from_axes(&states_on(&plan, &target, time)));
        Some(time_of_passage(at, (0.0, plan.duration()), place))
    }
}

/// Returns the states of the axes `time` seconds after the start of a plan to targets that move with their velocities.
pub(super) fn states_on(
    plan: &OnlineMotion<MAX_AXES>,
    target: &[AxisState; MAX_AXES],
    time: f64,
) -> [AxisState; MAX_AXES] {
    core::array::from_fn(|axis| {
        let state = plan.axes()[axis].state_at(time);
        let target = target[axis].advanced(time, 0.0);
        AxisState {
            position: state.position + target.position,
            velocity: state.velocity + target.velocity,
            acceleration: state.acceleration,
        }
    })
}
