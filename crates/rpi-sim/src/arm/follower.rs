//! The device function `follow_pose`: set-points of the axes for poses of the tool that a program computes cycle by cycle.
//!
//! It needs no motion of its own, so a program may compute the poses with one, and move them: on a belt, for example.

use super::kinematics::PerAxis;
use super::motion::same_joints;
use super::port::inverse_error_code;
use super::{Arm, kinematic_functions::put_joints};
use crate::device::{SlotWriter, pose_from};
use crate::error_code::ErrorCode;
use rpi_motion::{BackwardDifferences, JointTracker};

/// Number of slots of a pose.
const POSE_SLOTS: usize = 7;

/// Number of slots in the result of `follow_pose` besides those of the joints: pose and error code.
pub(super) const FOLLOW_SLOTS: u32 = POSE_SLOTS as u32 + 1;

/// Follower of poses of one arm.
#[derive(Clone, Debug)]
pub(super) struct PoseFollower {
    tracker: JointTracker,
    /// Simulated time at which the last set-point was computed, s.
    computed: f64,
    /// Period of the set-points, s.
    period: f64,
    /// Joint positions of the last set-point, rad.
    last: PerAxis,
}

impl PoseFollower {
    pub(super) fn new(arm: rpi_motion::Arm, tick: f64) -> Self {
        Self {
            tracker: JointTracker::new(arm, tick),
            computed: f64::NEG_INFINITY,
            period: tick,
            last: PerAxis::default(),
        }
    }
}

/// Calls the function `follow_pose` and writes its result to `out`. Returns false if there are too few arguments.
pub(super) fn call_follow_pose(arm: &mut Arm, arguments: &[u64], out: &mut SlotWriter<'_>) -> bool {
    if arguments.len() < POSE_SLOTS {
        return false;
    }
    let begins = begin_following(arm);
    // The axes may be behind the goals: the configuration is that of the goals.
    let goal = arm.follower.tracker.last_goal().filter(|_| !begins);
    let near = goal
        .copied()
        .unwrap_or(arm.commanded(|state| state.position));
    let axes = &near[..arm.axes()];
    let found = arm
        .kinematics
        .inverse(&pose_from(arguments), axes, axes)
        .map_err(inverse_error_code);
    let next = arm.follower.tracker.next_set_point(found.as_ref().ok());
    arm.follower.last = next.joints;
    put_joints(arm, next.joints, out);
    let pose = arm.kinematics.forward(&next.joints[..arm.axes()]);
    out.put_pose(&pose);
    let code = found.err().unwrap_or(ErrorCode::OK);
    out.put_bits(code.0.cast_unsigned());
    true
}

/// Begins to follow from the arm's state as commanded if the arm has not followed the last set-point of the follower. Returns
/// true if it begins.
fn begin_following(arm: &mut Arm) -> bool {
    let last = BackwardDifferences {
        position: arm.commanded(|state| state.position),
        velocity: arm.commanded(|state| state.velocity),
        acceleration: arm.commanded(|state| state.acceleration),
    };
    let period = arm.tick * f64::from(arm.set_point_ticks);
    let follower = &mut arm.follower;
    let is_due = (arm.time - follower.computed - period).abs() < period / 2.0;
    let goes_on =
        is_due && follower.period == period && same_joints(&last.position, &follower.last);
    follower.computed = arm.time;
    follower.period = period;
    if !goes_on {
        // The state as commanded is finite, because the arm has accepted it.
        let _ = follower
            .tracker
            .begin(&last, arm.motion.accepted_period, period);
    }
    !goes_on
}
