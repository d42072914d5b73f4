//! The start of a path on which axis 3 of a redundant arm keeps its value instead of the arm angle.

use crate::arm_angle::smooth_step;

/// Axis 3 of a redundant arm, held at one value from the start of a path until the arm angle (position of the elbow) is
/// held again.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HeldAxis {
    /// Value at which axis 3 is held, rad.
    third: f64,
    /// Positions along the path (m) between which the arm passes over to a held arm angle: start, end. Infinite while
    /// they are not known.
    over: (f64, f64),
}

impl HeldAxis {
    pub(crate) fn new(third: f64) -> Self {
        Self {
            third,
            over: (f64::INFINITY, f64::INFINITY),
        }
    }

    pub(crate) fn third(&self) -> f64 {
        self.third
    }

    pub(crate) fn is_open(&self) -> bool {
        self.over.0 == f64::INFINITY
    }

    pub(crate) fn end(&mut self, over: (f64, f64)) {
        self.over = over;
    }

    /// Weight of the arm angle that belongs to the held axis 3, at the position `s` (m) along the path: 1 while the
    /// axis is held, 0 where the arm angle is held instead.
    pub(crate) fn weight_at(&self, s: f64) -> f64 {
        match self.is_open() {
            true => 1.0,
            false => 1.0 - smooth_step((s - self.over.0) / (self.over.1 - self.over.0)),
        }
    }
}
