//! Watches set-points as a controller does: backward differences of each axis against its limits.
#![allow(dead_code, reason = "each test target uses a part")]

use nalgebra::Vector3;
use rpi_kin::state_to_rest::Bounds;
use rpi_motion::{Arm, JointState, Joints};

pub(crate) const PERIOD: f64 = 1e-3;

#[derive(Clone)]
pub(crate) struct Watch {
    last: [Joints; 4],
    /// Largest share of the limits of velocity, acceleration and jerk.
    pub(crate) worst: [f64; 3],
    pub(crate) out_of_range: bool,
}

impl Watch {
    pub(crate) fn standing(joints: &Joints) -> Self {
        Self {
            last: [*joints; 4],
            worst: [0.0; 3],
            out_of_range: false,
        }
    }

    pub(crate) fn push(&mut self, arm: &Arm, joints: &Joints) {
        self.last.rotate_left(1);
        self.last[3] = *joints;
        let [a, b, c, d] = &self.last;
        for (axis, limits) in arm.limits().iter().enumerate() {
            let velocity = (d[axis] - c[axis]) / PERIOD;
            let acceleration = (d[axis] - 2.0 * c[axis] + b[axis]) / (PERIOD * PERIOD);
            let jerk =
                (d[axis] - 3.0 * c[axis] + 3.0 * b[axis] - a[axis]) / (PERIOD * PERIOD * PERIOD);
            let shares = [
                velocity.abs() / limits.velocity,
                acceleration.abs() / limits.acceleration,
                jerk.abs() / limits.jerk,
            ];
            for (worst, share) in self.worst.iter_mut().zip(shares) {
                // `max` would lose a NaN.
                *worst = if share > *worst || share.is_nan() {
                    share
                } else {
                    *worst
                };
            }
            self.out_of_range |= !limits.position.shrunk(-1e-9).contains(joints[axis]);
        }
    }

    pub(crate) fn state(&self) -> JointState {
        let [_, b, c, d] = &self.last;
        let velocity = core::array::from_fn(|axis| (d[axis] - c[axis]) / PERIOD);
        let acceleration =
            core::array::from_fn(|axis| (d[axis] - 2.0 * c[axis] + b[axis]) / (PERIOD * PERIOD));
        JointState::from_differences(*d, velocity, acceleration, PERIOD)
    }

    pub(crate) fn joints(&self) -> &Joints {
        &self.last[3]
    }

    /// Limits are kept up to a millionth.
    pub(crate) fn is_within(&self) -> bool {
        !self.out_of_range && self.worst.iter().all(|worst| *worst <= 1.0 + 1e-6)
    }
}

/// Watches the tool along a path by the backward differences of its places, m.
#[derive(Default)]
pub(crate) struct ToolWatch {
    last: [Vector3<f64>; 4],
    count: usize,
}

impl ToolWatch {
    pub(crate) fn push(&mut self, place: Vector3<f64>) {
        self.last.rotate_left(1);
        self.last[3] = place;
        self.count += 1;
    }

    /// Speed, acceleration and jerk of the tool as shares of the requested ones; 0 before four places are known.
    pub(crate) fn shares(&self, requested: Bounds) -> [f64; 3] {
        if self.count < self.last.len() {
            return [0.0; 3];
        }
        let [a, b, c, d] = &self.last;
        [
            (d - c).norm() / PERIOD / requested.speed,
            (d - c * 2.0 + b).norm() / (PERIOD * PERIOD) / requested.acceleration,
            (d - (c - b) * 3.0 - a).norm() / (PERIOD * PERIOD * PERIOD) / requested.jerk,
        ]
    }
}
