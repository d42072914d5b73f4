//! Start of a path that may begin where the arm can be: its stopping point.

use crate::joint_path::JointPath;
use crate::path::Path;
use crate::ranges::allowed_ranges;
use crate::{Arm, JointState, Joints};
use rpi_kin::stop_profile::{StopProfile, VelocityState};
use rpi_kin::{AxisLimits, MAX_AXES};

/// Share of the limits of the axes with which the arm is assumed to stop. It is that of the takeover, so that the arm
/// need not swing back.
const GENTLE: f64 = 0.5;

/// Distance from the start of a path to the place with which its direction in joint space is computed, as a share of
/// the length of the path.
const STEP: f64 = 1e-3;
/// Maximum distance from the start of a path to the place with which its direction in joint space is computed, m.
const LONGEST_STEP: f64 = 1e-4;

/// Returns the joint positions (rad) at which a path to a new goal should begin for an arm in the state `state`: where
/// the arm comes to rest after the takeover, so that it need not swing back. `path` is the path from the present
/// position; the velocity along it continues and is not stopped. For an arm at rest, the result is its present
/// position.
///
/// Each axis stops with half of its limits, or with all of them if it would otherwise leave its range. The joint
/// positions lie within the ranges, or no farther out than the present ones.
#[must_use]
pub fn path_start(arm: &Arm, state: &JointState, path: &Path) -> Joints {
    let direction = direction(arm, path, &state.position).unwrap_or_default();
    let across = |values: &Joints| {
        let along = share_along(arm, values, &direction).max(0.0);
        core::array::from_fn::<f64, MAX_AXES, _>(|axis| values[axis] - along * direction[axis])
    };
    let (velocity, acceleration) = (across(&state.velocity), across(&state.acceleration));
    let ranges = allowed_ranges(arm, &state.position);
    let mut start = state.position;
    for (axis, limits) in arm.limits().iter().enumerate() {
        let (from, range) = (state.position[axis], &ranges[axis]);
        let stop =
            |share: f64| from + stopping_way(velocity[axis], acceleration[axis], limits, share);
        let gentle = stop(GENTLE);
        let end = if range.contains(gentle) {
            gentle
        } else {
            stop(1.0)
        };
        start[axis] = end.clamp(range.lower, range.upper);
    }
    start
}

/// Returns the signed distance (rad) until an axis is at rest, if it stops with the share `share` of its limits.
fn stopping_way(velocity: f64, acceleration: f64, limits: &AxisLimits, share: f64) -> f64 {
    let from = VelocityState {
        velocity,
        acceleration,
    };
    let stop = StopProfile::new(from, share * limits.acceleration, share * limits.jerk);
    stop.map_or(0.0, |stop| stop.distance())
}

/// Returns the derivative of the joint positions with respect to the path parameter at the start of a path; `None` if
/// it cannot be computed.
fn direction(arm: &Arm, path: &Path, start: &Joints) -> Option<Joints> {
    let step = (STEP * path.length()).min(LONGEST_STEP);
    let joint_path = JointPath::new(arm, *path, start);
    let first = joint_path.joints_at(arm, 0.0, start).ok()?;
    let next = joint_path.joints_at(arm, step, &first).ok()?;
    (step > 0.0).then(|| core::array::from_fn(|axis| (next[axis] - first[axis]) / step))
}

/// Returns the factor for `direction` that fits best to `values`, velocities or accelerations of the axes: least
/// squares, weighted by the velocity limits. 0 if `direction` is zero.
fn share_along(arm: &Arm, values: &Joints, direction: &Joints) -> f64 {
    let weighted = |of: &Joints| {
        let axes = arm.limits().iter().enumerate();
        axes.map(|(axis, limits)| of[axis] * direction[axis] / (limits.velocity * limits.velocity))
            .sum::<f64>()
    };
    let length = weighted(direction);
    if length > 0.0 {
        weighted(values) / length
    } else {
        0.0
    }
}
