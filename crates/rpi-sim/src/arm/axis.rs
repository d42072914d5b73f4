//! One axis of a simulated arm.

use super::guard::{State, Violation, judge};
use crate::cell::Enforced;
use crate::code::Code;
use rpi_kin::AxisLimits;

/// An axis: where it was told to be, where its drive is, where it is measured.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub(super) limits: AxisLimits,
    /// After the last set-point that was taken, or while braking.
    pub(super) commanded: State,
    /// The set-point of this tick, judged.
    pub(super) staged: Option<State>,
    /// Where the drive is on its way to the commanded position, in rad.
    pub(super) driven: f64,
    /// What is measured, without noise and latency.
    pub(super) measured: State,
    /// What is wrong with it.
    pub(super) code: Code,
}

impl Axis {
    pub(super) fn new(position: f64, limits: AxisLimits) -> Self {
        let standing = State::standing(position);
        Self {
            limits,
            commanded: standing,
            staged: None,
            driven: position,
            measured: standing,
            code: Code::OK,
        }
    }

    /// What a set-point would lead to, `period` (s) after the last.
    pub(super) fn judge(
        &self,
        target: f64,
        period: f64,
        enforced: Enforced,
    ) -> Result<State, Violation> {
        judge(&self.commanded, target, period, &self.limits, enforced)
    }

    /// Whether it moves and nobody said where to.
    pub(super) fn is_left_alone(&self) -> bool {
        self.staged.is_none() && self.commanded.is_moving()
    }

    /// What was wrong with a set-point is not any more, only that the joint has failed.
    pub(super) fn forget_refusal(&mut self) {
        if !self.code.is_failure() {
            self.code = Code::OK;
        }
    }

    /// Takes the staged set-point, or holds if there is none.
    pub(super) fn take(&mut self) {
        let held = State::standing(self.commanded.position);
        self.commanded = self.staged.take().unwrap_or(held);
    }

    /// Moves the drive on its way, which takes `left` more ticks.
    pub(super) fn drive(&mut self, left: u32) {
        self.driven = match left {
            0 | 1 => self.commanded.position,
            _ => self.driven + (self.commanded.position - self.driven) / f64::from(left),
        };
    }

    /// Goes on at a velocity for one tick (s), as the arm's own brake wants it.
    pub(super) fn coast(&mut self, velocity: f64, tick: f64) {
        let from = State {
            position: self.driven,
            ..self.commanded
        };
        self.commanded = from.followed_by(self.driven + velocity * tick, tick);
        self.driven = self.commanded.position;
    }

    /// Lets what is measured follow the drive; `share` of the way is made up in one tick (s).
    pub(super) fn measure(&mut self, share: f64, tick: f64) {
        let from = self.measured.position;
        self.measured = self
            .measured
            .followed_by(from + (self.driven - from) * share, tick);
    }
}
