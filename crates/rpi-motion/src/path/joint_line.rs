//! Straight line in joint space: a synchronised point-to-point motion.

use crate::Joints;

/// Straight line in joint space between two sets of joint positions. All axes arrive together, since they share one
/// path parameter: the way of the axis that moves farthest, rad.
#[derive(Clone, Copy, Debug)]
pub struct JointLine {
    start: Joints,
    /// Change of each joint per unit of the path parameter, from -1 to 1; 1 or -1 for the axis that moves farthest.
    direction: Joints,
    length: f64,
}

impl JointLine {
    /// Creates the line between the joint positions `from` and `to` (rad), of which the `axes` first ones move.
    #[must_use]
    pub fn new(from: &Joints, to: &Joints, axes: usize) -> Self {
        let way: Joints = core::array::from_fn(|axis| {
            if axis < axes {
                to[axis] - from[axis]
            } else {
                0.0
            }
        });
        let length = way.iter().fold(0.0f64, |most, way| most.max(way.abs()));
        Self {
            start: *from,
            direction: way.map(|way| if length > 0.0 { way / length } else { 0.0 }),
            length,
        }
    }

    /// Returns the distance that the farthest moving axis travels, rad.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Returns the change of each joint per unit of the path parameter, from -1 to 1.
    #[must_use]
    pub fn direction(&self) -> &Joints {
        &self.direction
    }

    /// Returns the joint positions (rad) at the value `s` (rad) of the path parameter.
    #[must_use]
    pub fn joints(&self, s: f64) -> Joints {
        core::array::from_fn(|axis| self.start[axis] + self.direction[axis] * s)
    }
}
