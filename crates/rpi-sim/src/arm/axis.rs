//! One axis of a simulated arm.

use super::limit_usage::LimitUsage;
use super::limits::{AxisState, Violation, check_set_point};
use crate::cell::EnforcedLimits;
use crate::error_code::ErrorCode;
use rpi_kin::AxisLimits;

/// An axis of a simulated arm: its limits, its commanded, driven and measured positions, and its error code.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub(super) limits: AxisLimits,
    /// State of the axis according to the last accepted set-point, or to braking.
    pub(super) commanded: AxisState,
    /// State of the axis according to the set-point accepted in this tick, not yet applied; `None` without a set-point.
    pub(super) staged: Option<AxisState>,
    /// Position of the drive, which moves to the commanded position over several ticks, in rad.
    pub(super) driven: f64,
    /// Measured state, before noise and latency are added.
    pub(super) measured: AxisState,
    /// Present error code of the axis; 0 for none.
    pub(super) code: ErrorCode,
    /// Use of the limits by all set-points so far.
    pub(super) usage: LimitUsage,
}

impl Axis {
    pub(super) fn new(position: f64, limits: AxisLimits) -> Self {
        let standing = AxisState::at_rest(position);
        Self {
            limits,
            commanded: standing,
            staged: None,
            driven: position,
            measured: standing,
            code: ErrorCode::OK,
            usage: LimitUsage::default(),
        }
    }

    /// Checks the set-point `target` (rad), which follows the last one after `period` (s), against the enforced limits.
    /// Returns the state of the axis that it leads to, or the violated limit.
    pub(super) fn check_set_point(
        &self,
        target: f64,
        period: f64,
        enforced: EnforcedLimits,
    ) -> Result<AxisState, Violation> {
        check_set_point(&self.commanded, target, period, &self.limits, enforced)
    }

    /// True if the axis moves and has no set-point in this tick.
    pub(super) fn lacks_set_point(&self) -> bool {
        self.staged.is_none() && self.commanded.is_moving()
    }

    /// Clears the error code of a rejected set-point, but not that of a failure of the joint.
    pub(super) fn clear_rejection(&mut self) {
        if !self.code.is_failure() {
            self.code = ErrorCode::OK;
        }
    }

    /// Applies the set-point of this tick; without one, the axis holds its position.
    pub(super) fn apply_set_point(&mut self) {
        let held = AxisState::at_rest(self.commanded.position);
        self.commanded = self.staged.take().unwrap_or(held);
    }

    /// Applies the set-point of this tick, which follows the last one after `period` (s), at `time` (s), and takes note of the use
    /// of the limits.
    pub(super) fn follow_set_point(&mut self, period: f64, time: f64) {
        let before = self.commanded;
        self.apply_set_point();
        self.usage
            .observe([&before, &self.commanded], &self.limits, period, time);
    }

    /// Moves the drive by one tick towards the commanded position, which it reaches after `left` ticks.
    pub(super) fn drive(&mut self, left: u32) {
        self.driven = match left {
            0 | 1 => self.commanded.position,
            _ => self.driven + (self.commanded.position - self.driven) / f64::from(left),
        };
    }

    /// Moves the axis with the velocity `velocity` (rad/s) for one tick of `tick` seconds, while the arm brakes.
    pub(super) fn move_braking(&mut self, velocity: f64, tick: f64) {
        let from = AxisState {
            position: self.driven,
            ..self.commanded
        };
        self.commanded = from.after_set_point(self.driven + velocity * tick, tick);
        self.driven = self.commanded.position;
    }

    /// Moves the axis to the position `position` (rad) in one tick of `tick` seconds, while the arm brakes on a path.
    pub(super) fn brake_to(&mut self, position: f64, tick: f64) {
        self.commanded = self.commanded.after_set_point(position, tick);
        self.driven = position;
    }

    /// Moves the measured position towards the drive by the fraction `share` (0 to 1) of their difference, in one tick
    /// of `tick` seconds.
    pub(super) fn measure(&mut self, share: f64, tick: f64) {
        let from = self.measured.position;
        self.measured = self
            .measured
            .after_set_point(from + (self.driven - from) * share, tick);
    }
}
