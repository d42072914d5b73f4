//! A place on the path in joint space, and what it allows.

use crate::path::Curvature;
use crate::speed_limit::{SpeedBound, SpeedLimit, steady_speed};
use crate::{Arm, Joints};
use rpi_kin::state_to_rest::Bounds;

/// Share of the limits of velocity and acceleration that a plan uses. The rest covers the bending of the path between
/// samples of the verification (measured: at most 0.6 of 1 %).
pub const USED_SHARE: f64 = 0.99;

/// Share of the jerk limit that a plan uses (measured: at most 0.25 of 2 % are bending between samples).
pub const USED_JERK_SHARE: f64 = 0.98;

/// Share of the jerk limit that a plan on a spline uses: where two of its pieces meet, the third derivative of the way
/// jumps, between two nodes (measured: 2.4 % beyond what the nodes show).
pub const USED_JERK_SHARE_ON_SPLINE: f64 = 0.93;

/// Derivatives of the joints along the path at one place, and what they allow.
#[derive(Clone, Copy, Debug, Default)]
pub struct Node {
    /// Path parameter.
    pub s: f64,
    /// Joints, rad.
    pub joints: Joints,
    /// First derivatives, rad per unit of the path parameter.
    pub first: Joints,
    /// Second derivatives of the joints with respect to the path parameter.
    pub second: Joints,
    /// Third derivatives of the joints with respect to the path parameter.
    pub third: Joints,
    /// Curvature of the way of the tool.
    pub curvature: Curvature,
    /// Greatest distance at which the curvature is well known between two places.
    pub resolution: f64,
    /// Greatest velocity, acceleration and jerk of the path parameter here, each on its own.
    pub most: MostAllowed,
    /// Bound that limits this velocity; `None` if it is the requested one.
    pub speed_bound: Option<SpeedBound>,
}

/// Greatest velocity, acceleration and jerk of the path parameter.
#[derive(Clone, Copy, Debug)]
pub struct MostAllowed {
    /// Greatest velocity of the path parameter.
    pub velocity: f64,
    /// Greatest acceleration of the path parameter.
    pub acceleration: f64,
    /// Greatest jerk of the path parameter.
    pub jerk: f64,
}

impl Node {
    /// Returns the limit of the speed at the node, if it is lower than the requested one.
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
    /// Returns the smaller of both in each entry.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        Self {
            velocity: self.velocity.min(other.velocity),
            acceleration: self.acceleration.min(other.acceleration),
            jerk: self.jerk.min(other.jerk),
        }
    }
}

/// Returns the velocity, acceleration and jerk of the path parameter that the axes and the requested bounds of the tool
/// allow at a node, and the bound that limits the velocity; `None` if it is the requested one. `jerk_share` is the share of
/// the jerk limits of the axes that is used.
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

/// Returns the shares of the acceleration and the jerk of the tool that a steady speed uses at a place with this
/// curvature.
pub(crate) fn tool_shares(requested: Bounds, curvature: Curvature, speed: f64) -> (f64, f64) {
    let Curvature { value, slope } = curvature;
    (
        value * speed * speed / requested.acceleration,
        libm::hypot(slope, value * value) * speed * speed * speed / requested.jerk,
    )
}
