//! Why a path is followed more slowly than requested, and where.

use crate::Arm;
use crate::node::{Node, USED_SHARE};
use rpi_kin::state_to_rest::Bounds;

/// Bound that limits the speed at a place on a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpeedBound {
    /// The requested acceleration of the tool: the path is curved.
    ToolAcceleration,
    /// The requested jerk of the tool: the curvature is large or changes fast.
    ToolJerk,
    /// The velocity limit of an axis of the arm.
    AxisVelocity {
        /// Number of the axis, from 0.
        axis: usize,
    },
    /// The acceleration limit of an axis of the arm.
    AxisAcceleration {
        /// Number of the axis, from 0.
        axis: usize,
    },
    /// The jerk limit of an axis of the arm.
    AxisJerk {
        /// Number of the axis, from 0.
        axis: usize,
    },
}

/// Place on a path at which the motion must be slower than requested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedLimit {
    /// Position of the place along the path (path parameter), m (rad on a joint line).
    pub s: f64,
    /// Maximum constant velocity along the path at the place, m/s (rad/s on a joint line).
    pub velocity: f64,
    /// Bound that does not allow a higher velocity.
    pub bound: SpeedBound,
}

impl core::fmt::Display for SpeedBound {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            SpeedBound::ToolAcceleration => f.write_str("acceleration of the tool on the curve"),
            SpeedBound::ToolJerk => f.write_str("jerk of the tool on the curve"),
            SpeedBound::AxisVelocity { axis } => write!(f, "velocity of axis {}", axis + 1),
            SpeedBound::AxisAcceleration { axis } => write!(f, "acceleration of axis {}", axis + 1),
            SpeedBound::AxisJerk { axis } => write!(f, "jerk of axis {}", axis + 1),
        }
    }
}

impl core::fmt::Display for SpeedLimit {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "{:.4} m/s at most, {:.4} m from the start of the path: {}",
            self.velocity, self.s, self.bound
        )
    }
}

/// Returns the limit with the lower velocity; the first one if the velocities are equal. `None` stands for no limit.
pub(crate) fn slower(one: Option<SpeedLimit>, other: Option<SpeedLimit>) -> Option<SpeedLimit> {
    match (one, other) {
        (Some(first), Some(second)) if second.velocity < first.velocity => other,
        (None, _) => other,
        _ => one,
    }
}

/// Share of the requested acceleration or jerk of the tool that a constant speed on a curve uses at most.
const STEADY: f64 = 0.985;

/// Share of the acceleration limit of an axis that a constant speed along the path uses at most. The rest remains for
/// speeding up and braking.
const STEADY_ACCELERATION: f64 = 0.7;
/// Share of the jerk limit of an axis that a constant speed along the path uses at most. The rest remains for speeding
/// up and braking.
const STEADY_JERK: f64 = 0.6;

/// Returns the maximum constant velocity along the path at a node, and the bound that limits it; `None` if it is the
/// requested velocity. At a constant velocity v, the acceleration of the tool is k v² and its jerk c v³, with the
/// curvature k and the magnitude c of the third derivative of the path. The verification checks them together with the
/// acceleration and jerk along the path.
pub(crate) fn steady_speed(arm: &Arm, node: &Node, requested: Bounds) -> (f64, Option<SpeedBound>) {
    let curvature = node.largest_curvature();
    let value = curvature.value;
    let turning = curvature.third_derivative().max(1e-9);
    let mut most = (requested.speed, None);
    let mut take = |velocity: f64, bound: SpeedBound| {
        if velocity < most.0 {
            most = (velocity, Some(bound));
        }
    };
    let sideways = libm::sqrt(requested.acceleration / value.max(1e-9));
    take(STEADY * sideways, SpeedBound::ToolAcceleration);
    take(
        STEADY * rpi_math::cbrt(requested.jerk / turning),
        SpeedBound::ToolJerk,
    );
    for (axis, limits) in arm.limits().iter().enumerate() {
        let size = |value: f64| libm::fabs(value).max(1e-9);
        let (first, second, third) = (
            size(node.first[axis]),
            size(node.second[axis]),
            size(node.third[0][axis]).max(size(node.third[1][axis])),
        );
        let by_acceleration = libm::sqrt(STEADY_ACCELERATION * limits.acceleration / second);
        let by_jerk = rpi_math::cbrt(STEADY_JERK * limits.jerk / third);
        take(
            USED_SHARE * limits.velocity / first,
            SpeedBound::AxisVelocity { axis },
        );
        take(by_acceleration, SpeedBound::AxisAcceleration { axis });
        take(by_jerk, SpeedBound::AxisJerk { axis });
    }
    most
}
