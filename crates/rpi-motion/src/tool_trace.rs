//! The last set-points, and how far the tool exceeds its requested bounds on its way on to a path.

use crate::set_point::SetPoint;
use crate::tool_entry::tool_shares;
use crate::{Arm, JointState, Joints};
use nalgebra::Vector3;
use rpi_kin::state_to_rest::Bounds;

/// Number of set-points that are kept.
const KEPT: usize = 4;

/// The last set-points and places of the tool, the newest last, and the greatest shares of its bounds that it has used since the takeover.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ToolTrace {
    joints: [Joints; KEPT],
    places: [Vector3<f64>; 4],
    pub worst: [f64; 3],
}

impl ToolTrace {
    /// Begins at the takeover of an arm in a state. If it does not continue the last set-points, those before it follow
    /// from velocity and acceleration.
    pub(crate) fn begin(&mut self, arm: &Arm, state: &JointState, period: f64, continues: bool) {
        self.worst = [0.0; 3];
        if continues {
            return;
        }
        self.joints = core::array::from_fn(|k| {
            let time = (k as f64 - (KEPT - 1) as f64) * period;
            core::array::from_fn(|axis| {
                let half = state.acceleration[axis] * time / 2.0;
                state.position[axis] + time * (state.velocity[axis] + half)
            })
        });
        self.places = self
            .joints
            .map(|joints| arm.forward(&joints).translation.vector);
    }

    /// Returns the set-point `back` periods before the last one; the oldest one if it is not kept.
    pub(crate) fn joints(&self, back: usize) -> &Joints {
        &self.joints[(KEPT - 1).saturating_sub(back)]
    }

    /// Takes the next set-point; what the tool does on the path does not count.
    pub(crate) fn push(&mut self, arm: &Arm, at: &SetPoint, period: f64, requested: Bounds) {
        self.joints.rotate_left(1);
        self.joints[KEPT - 1] = at.joints;
        self.places.rotate_left(1);
        self.places[3] = arm.forward(&at.joints).translation.vector;
        if at.on_path {
            return;
        }
        for (worst, share) in
            self.worst
                .iter_mut()
                .zip(tool_shares(&self.places, period, requested))
        {
            *worst = worst.max(share);
        }
    }
}
