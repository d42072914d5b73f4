//! The last set-points, and how far the tool exceeds its requested bounds on its way on to a path.

use crate::set_point::SetPoint;
use crate::tool_entry::tool_shares;
use crate::{Arm, JointState, Joints};
use nalgebra::Vector3;
use rpi_kin::state_to_rest::Bounds;

/// Number of set-points that are stored.
const KEPT: usize = 4;

/// The last set-points, the newest last, and the maximum speed, acceleration and jerk of the tool since the takeover, as
/// shares of the requested ones.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ToolTrace {
    joints: [Joints; KEPT],
    /// Positions of the tool at the last set-points, m. They are not continued once the arm is on the path.
    places: [Vector3<f64>; KEPT],
    pub worst: [f64; 3],
}

impl ToolTrace {
    /// Begins the record of a takeover in the state `state` of the arm. If this state does not continue the last
    /// set-points (`continues` false), earlier set-points are computed from its velocity and acceleration.
    pub(crate) fn begin(&mut self, arm: &Arm, state: &JointState, period: f64, continues: bool) {
        self.worst = [0.0; 3];
        if !continues {
            self.joints = core::array::from_fn(|k| {
                let time = (k as f64 - (KEPT - 1) as f64) * period;
                core::array::from_fn(|axis| {
                    let half = state.acceleration[axis] * time / 2.0;
                    state.position[axis] + time * (state.velocity[axis] + half)
                })
            });
        }
        self.places = self.joints.map(|joints| arm.tool_position(&joints));
    }

    /// Returns the joint positions (rad) `back` set-points before the last one; the oldest stored ones if there are
    /// fewer.
    pub(crate) fn joints(&self, back: usize) -> &Joints {
        &self.joints[(KEPT - 1).saturating_sub(back)]
    }

    /// Returns the state of the axes on the parabola through the last set-points, which are `period` seconds apart.
    pub(crate) fn state(&self, period: f64) -> JointState {
        let [_, b, c, d] = &self.joints;
        let velocity = core::array::from_fn(|axis| (d[axis] - c[axis]) / period);
        let acceleration =
            core::array::from_fn(|axis| (d[axis] - 2.0 * c[axis] + b[axis]) / (period * period));
        JointState::from_differences(*d, velocity, acceleration, period)
    }

    /// Appends a set-point. The maxima are updated only while the arm is not on the path.
    pub(crate) fn push(&mut self, arm: &Arm, at: &SetPoint, period: f64, requested: Bounds) {
        self.joints.rotate_left(1);
        self.joints[KEPT - 1] = at.joints;
        if at.on_path {
            return;
        }
        self.places.rotate_left(1);
        self.places[KEPT - 1] = arm.tool_position(&at.joints);
        for (worst, share) in
            self.worst
                .iter_mut()
                .zip(tool_shares(&self.places, period, requested))
        {
            *worst = worst.max(share);
        }
    }
}
