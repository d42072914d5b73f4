//! The start of a path on which axis 3 of a redundant arm keeps its value instead of the arm angle.

use crate::arm_angle::smooth_step;

/// Axis 3 held from the start of the path, until the arm angle is held again.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HeldAxis {
    /// Value of axis 3, rad.
    third: f64,
    /// Where the arm angle passes over to the held one: from, to. Infinite while that is not known.
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

    /// Share of the arm angle with axis 3 held, from 1 to 0.
    pub(crate) fn weight_at(&self, s: f64) -> f64 {
        match self.is_open() {
            true => 1.0,
            false => 1.0 - smooth_step((s - self.over.0) / (self.over.1 - self.over.0)),
        }
    }
}
