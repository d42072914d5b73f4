//! How far the tool exceeds its requested bounds on its way on to a path.

use crate::set_point::SetPoint;
use crate::tool_entry::tool_shares;
use crate::{Arm, JointState};
use nalgebra::Vector3;
use rpi_kin::state_to_rest::Bounds;

/// The last places of the tool, and the greatest shares of its bounds that it has used since the takeover.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ToolTrace {
    places: [Vector3<f64>; 4],
    pub worst: [f64; 3],
}

impl ToolTrace {
    /// Begins at the takeover of an arm in a state: the places before it follow from velocity and acceleration.
    pub(crate) fn begin(&mut self, arm: &Arm, state: &JointState, period: f64) {
        self.worst = [0.0; 3];
        self.places = core::array::from_fn(|k| {
            let time = (k as f64 - 3.0) * period;
            let joints = core::array::from_fn(|axis| {
                let half = state.acceleration[axis] * time / 2.0;
                state.position[axis] + time * (state.velocity[axis] + half)
            });
            arm.forward(&joints).translation.vector
        });
    }

    /// Takes the next set-point; what the tool does on the path does not count.
    pub(crate) fn push(&mut self, arm: &Arm, at: &SetPoint, period: f64, requested: Bounds) {
        if at.on_path {
            return;
        }
        self.places.rotate_left(1);
        self.places[3] = arm.forward(&at.joints).translation.vector;
        for (worst, share) in
            self.worst
                .iter_mut()
                .zip(tool_shares(&self.places, period, requested))
        {
            *worst = worst.max(share);
        }
    }
}
