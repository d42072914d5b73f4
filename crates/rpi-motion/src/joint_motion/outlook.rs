//! When the axes will be where, as planned now.

use super::{JointGoal, JointMotion};
use crate::online::{MotionOptions, OnlineMotion, Synchronization};
use crate::passage::time_of_passage;
use crate::{JointState, Joints};
use rpi_kin::MAX_AXES;

impl JointMotion {
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
        let limits = self.limits(&goal, speed_share);
        let options = MotionOptions {
            synchronization: Synchronization::Time,
            minimum_duration: 0.0,
        };
        let plan = OnlineMotion::<MAX_AXES>::to_position(
            &self.state,
            &self.target(&goal),
            &limits,
            options,
        );
        let plan = plan.ok()?;
        let at = |time: f64| distance(&self.joint_state(&plan.state_at(time)));
        Some(time_of_passage(at, (0.0, plan.duration()), place))
    }
}
