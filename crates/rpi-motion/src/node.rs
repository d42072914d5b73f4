//! A place on the path in joint space, and what it allows.

use crate::path::Curvature;
use crate::{Arm, Joints};
use rpi_kin::state_to_rest::Bounds;

/// Share of the limits of velocity and acceleration that a plan uses. The rest covers the bending of the path between
/// samples of the verification (measured: at most 0.6 of 1 %).
pub const USED_SHARE: f64 = 0.99;

/// Share of the jerk limit that a plan uses (measured: at most 0.25 of 2 % are bending between samples).
pub const USED_JERK_SHARE: f64 = 0.98;

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

/// Returns the velocity, acceleration and jerk of the path parameter that the limits of the axes allow at a node. The
/// shares of acceleration (0.7) and jerk (0.6) that the speed may use up alone leave room for the acceleration and the
/// jerk of the path parameter.
pub(crate) fn axis_bounds(arm: &Arm, node: &Node) -> MostAllowed {
    let mut most = MostAllowed::default();
    for (axis, limits) in arm.limits().iter().enumerate() {
        let first = node.first[axis].abs().max(1e-9);
        let second = node.second[axis].abs().max(1e-9);
        let third = node.third[axis].abs().max(1e-9);
        let by_acceleration = libm::sqrt(0.7 * limits.acceleration / second);
        let by_jerk = libm::cbrt(0.6 * limits.jerk / third);
        most = most.min(MostAllowed {
            velocity: (USED_SHARE * limits.velocity / first)
                .min(by_acceleration)
                .min(by_jerk),
            acceleration: USED_SHARE * limits.acceleration / first,
            jerk: USED_JERK_SHARE * limits.jerk / first,
        });
    }
    most
}

/// Returns the velocity, acceleration and jerk of the path parameter that the bounds of the tool allow at a place with
/// this curvature. At a steady speed the acceleration is k v² and the jerk hypot(k', k²) v³; the verification looks at
/// both together with those along the path.
pub(crate) fn tool_bounds(requested: Bounds, curvature: Curvature) -> MostAllowed {
    /// Share of its own bounds that a steady speed uses.
    const STEADY: f64 = 0.985;
    let Curvature { value, slope } = curvature;
    let sideways = libm::sqrt(requested.acceleration / value.max(1e-9));
    let turning = libm::hypot(slope, value * value).max(1e-9);
    let twisting = libm::cbrt(requested.jerk / turning);
    MostAllowed {
        velocity: requested
            .speed
            .min(STEADY * sideways)
            .min(STEADY * twisting),
        acceleration: requested.acceleration,
        jerk: requested.jerk,
    }
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
