//! A place on the path in joint space, and what it allows.

use crate::curve_bound::CurveBound;
use crate::path::Curvature;
use crate::speed_limit::{SpeedBound, SpeedLimit, steady_speed};
use crate::{Arm, Joints};
use rpi_kin::state_to_rest::Bounds;

/// Share of the limits of velocity and acceleration of the axes that a plan uses. The rest covers deviations of the
/// path between the samples of the verification (measured: at most 0.6 % of the limits).
pub const USED_SHARE: f64 = 0.99;

/// Share of the jerk limits of the axes that a plan uses. The rest covers deviations of the path between the samples of
/// the verification (measured: at most 0.25 % of the limits).
pub const USED_JERK_SHARE: f64 = 0.98;

/// Share of the jerk limits of the axes that a plan on a spline uses. Where two pieces of the spline meet between two
/// nodes, its third derivative jumps (measured: 2.4 % beyond the values at the nodes).
pub const USED_JERK_SHARE_ON_SPLINE: f64 = 0.93;

/// Node of a path: a place with the derivatives of the joint positions, and the motion that the limits allow there.
#[derive(Clone, Copy, Debug, Default)]
pub struct Node {
    /// Position of the node along the path, from its start: m; rad on a line in joint space.
    pub s: f64,
    /// Joint positions at the node, rad.
    pub joints: Joints,
    /// First derivatives of the joint positions with respect to the position along the path, rad/m (rad/rad on a joint
    /// line).
    pub first: Joints,
    /// Second derivatives of the joints with respect to the path parameter, rad/m² (rad/rad² on a joint line).
    pub second: Joints,
    /// Smallest and largest third derivatives of the joints with respect to the path parameter near the node, rad/m³
    /// (rad/rad³ on a joint line). They differ only next to a point of a spline, where the derivatives jump.
    pub third: [Joints; 2],
    /// Curvature of the path of the tool at the node.
    pub curvature: Curvature,
    /// Curvature at the points of a spline between the previous node and this one, at which its derivatives jump, and the
    /// position of the last of them along the path, m; `None` without one.
    pub kink: Option<(f64, CurveBound)>,
    /// Maximum distance between two nodes here for which the curvature is known well enough in between, m.
    pub resolution: f64,
    /// Maximum velocity, acceleration and jerk along the path at the node, each without regard to the others.
    pub most: MostAllowed,
    /// Bound that limits the velocity along the path at the node; `None` if it is the requested velocity.
    pub speed_bound: Option<SpeedBound>,
}

/// Maximum velocity, acceleration and jerk along a path that the limits allow.
#[derive(Clone, Copy, Debug)]
pub struct MostAllowed {
    /// Maximum velocity along the path, m/s; rad/s on a line in joint space.
    pub velocity: f64,
    /// Maximum acceleration along the path, m/s²; rad/s² on a line in joint space.
    pub acceleration: f64,
    /// Maximum jerk along the path, m/s³; rad/s³ on a line in joint space.
    pub jerk: f64,
}

impl Node {
    /// Returns the largest curvature, with the largest derivatives, at the node and at the points of a spline before it.
    pub(crate) fn largest_curvature(&self) -> Curvature {
        let kink = self
            .kink
            .map_or_else(CurveBound::default, |kink| kink.1)
            .largest();
        let own = self.curvature;
        Curvature {
            value: own.value.max(kink.value),
            slope: libm::fabs(own.slope).max(kink.slope),
            twist: own.twist.max(kink.twist),
        }
    }

    /// Returns the limit of the velocity at the node if it is lower than the requested velocity; `None` otherwise.
    #[must_use]
    pub fn speed_limit(&self) -> Option<SpeedLimit> {
        self.speed_bound.map(|bound| SpeedLimit {
            s: self.s,
            velocity: self.most.velocity,
            bound,
        })
    }
}

impl Default for MostAllowed {
    fn default() -> Self {
        Self {
            velocity: f64::INFINITY,
            acceleration: f64::INFINITY,
            jerk: f64::INFINITY,
        }
    }
}

impl MostAllowed {
    /// Returns, for velocity, acceleration and jerk, the smaller one of both values.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        Self {
            velocity: self.velocity.min(other.velocity),
            acceleration: self.acceleration.min(other.acceleration),
            jerk: self.jerk.min(other.jerk),
        }
    }
}

/// Returns the velocity, acceleration and jerk along the path that the axes and the requested bounds of the tool allow
/// at a node, and the bound that limits the velocity; `None` if it is the requested velocity. `jerk_share` is the share
/// of the jerk limits of the axes that may be used.
pub(crate) fn bounds_at(
    arm: &Arm,
    node: &Node,
    requested: Bounds,
    jerk_share: f64,
) -> (MostAllowed, Option<SpeedBound>) {
    let (velocity, bound) = steady_speed(arm, node, requested);
    let mut most = MostAllowed {
        velocity,
        acceleration: requested.acceleration,
        jerk: requested.jerk,
    };
    for (axis, limits) in arm.limits().iter().enumerate() {
        let first = node.first[axis].abs().max(1e-9);
        let along = USED_SHARE * limits.acceleration / first;
        most.acceleration = most.acceleration.min(along);
        most.jerk = most.jerk.min(jerk_share * limits.jerk / first);
    }
    (most, bound)
}

/// Returns the acceleration and the jerk of the tool at a constant speed (m/s) on this curvature, as shares of the
/// requested ones.
pub(crate) fn tool_shares(requested: Bounds, curvature: Curvature, speed: f64) -> (f64, f64) {
    (
        curvature.value * speed * speed / requested.acceleration,
        curvature.third_derivative() * speed * speed * speed / requested.jerk,
    )
}
