//! Why a path is followed more slowly than requested, and where.

use crate::Arm;
use crate::node::{Node, USED_SHARE};
use crate::path::Curvature;
use rpi_kin::state_to_rest::Bounds;

/// Bound that limits the speed at a place of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpeedBound {
    /// The requested acceleration of the tool: the path is curved.
    ToolAcceleration,
    /// The requested jerk of the tool: the curvature is large or changes fast.
    ToolJerk,
    /// The velocity limit of an axis.
    AxisVelocity {
        /// Number of the axis, from 0.
        axis: usize,
    },
    /// The acceleration limit of an axis.
    AxisAcceleration {
        /// Number of the axis, from 0.
        axis: usize,
    },
    /// The jerk limit of an axis.
    AxisJerk {
        /// Number of the axis, from 0.
        axis: usize,
    },
}

/// Place at which a path is followed more slowly than requested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedLimit {
    /// Path parameter of the place, m (rad on a joint line).
    pub s: f64,
    /// Greatest steady velocity of the path parameter there, in its unit per second.
    pub velocity: f64,
    /// Bound that allows no more.
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

/// Returns the lower limit of both; the first one if they are equal.
pub(crate) fn slower(one: Option<SpeedLimit>, other: Option<SpeedLimit>) -> Option<SpeedLimit> {
    match (one, other) {
        (Some(first), Some(second)) if second.velocity < first.velocity => other,
        (None, _) => other,
        _ => one,
    }
}

/// Share of its own bounds that a steady speed on a curve uses.
const STEADY: f64 = 0.985;

/// Shares of the acceleration and the jerk of an axis that a steady speed uses; the rest remains for the acceleration
/// and the jerk of the path parameter.
const STEADY_ACCELERATION: f64 = 0.7;
const STEADY_JERK: f64 = 0.6;

/// Returns the greatest steady velocity of the path parameter at a node, and the bound for it; `None` if it is the
/// requested one. At a steady speed, the acceleration of the tool is k v² and its jerk hypot(k', k²) v³; the
/// verification looks at both together with those along the path.
pub(crate) fn steady_speed(arm: &Arm, node: &Node, requested: Bounds) -> (f64, Option<SpeedBound>) {
    let Curvature { value, slope } = node.curvature;
    let turning = libm::hypot(slope, value * value).max(1e-9);
    let mut most = (requested.speed, None);
    let mut take = |velocity: f64, bound: SpeedBound| {
        if velocity < most.0 {
            most = (velocity, Some(bound));
        }
    };
    let sideways = libm::sqrt(requested.acceleration / value.max(1e-9));
    take(STEADY * sideways, SpeedBound::ToolAcceleration);
    take(
        STEADY * libm::cbrt(requested.jerk / turning),
        SpeedBound::ToolJerk,
    );
    for (axis, limits) in arm.limits().iter().enumerate() {
        let size = |value: f64| libm::fabs(value).max(1e-9);
        let (first, second, third) = (
            size(node.first[axis]),
            size(node.second[axis]),
            size(node.third[axis]),
        );
        let by_acceleration = libm::sqrt(STEADY_ACCELERATION * limits.acceleration / second);
        let by_jerk = libm::cbrt(STEADY_JERK * limits.jerk / third);
        take(
            USED_SHARE * limits.velocity / first,
            SpeedBound::AxisVelocity { axis },
        );
        take(by_acceleration, SpeedBound::AxisAcceleration { axis });
        take(by_jerk, SpeedBound::AxisJerk { axis });
    }
    most
}
