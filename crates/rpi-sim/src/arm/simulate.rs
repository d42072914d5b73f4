//! Simulation of an arm from tick to tick.

use super::Arm;
use super::axis::Axis;
use super::brake::Brake;
use super::limits::Violation;
use super::motion::report_events_of_ended_motion;
use super::watchdog::bridge_missing_set_points;
use crate::device::Report;
use crate::error_code::ErrorCode;

impl Arm {
    /// Simulates one tick, which ends at the simulated time `time` (s): applies set-points, moves the drives, takes
    /// samples.
    pub fn step(&mut self, time: f64) {
        self.time = time;
        self.update_faults();
        report_events_of_ended_motion(self);
        if self.faults.effects.set_points_lost {
            self.drop_staged();
        }
        self.decide();
        if self.brake.is_some() {
            self.move_braking();
        } else {
            self.drive();
        }
        self.sensing.sample(&mut self.axes, &self.faults.effects);
    }

    /// Decides what the arm does in this tick: it follows set-points, brakes, or rests.
    fn decide(&mut self) {
        let stop_requested = core::mem::take(&mut self.stop_requested);
        if stop_requested || self.has_failed() {
            return self.begin_braking();
        }
        let came = self.axes.iter().any(|axis| axis.staged.is_some());
        let left_alone = self.axes.iter().any(Axis::lacks_set_point);
        // The tuple: some axis has a set-point, some moving axis has none, the arm brakes.
        match (came, left_alone, self.brake.is_some()) {
            (true, false, _) => self.take_set_points(),
            (true, true, true) => self.reject_while_braking(),
            (false, _, _) if self.ticks_left > 0 => {}
            (_, true, false) => {
                if !bridge_missing_set_points(self) {
                    self.report_missing_set_points();
                }
            }
            (false, false, false) => self.axes.iter_mut().for_each(Axis::apply_set_point),
            (false, _, true) => {}
        }
    }

    fn take_set_points(&mut self) {
        self.brake = None;
        self.missed_periods = 0;
        self.motion.end_braking();
        self.axes.iter_mut().for_each(Axis::apply_set_point);
        self.ticks_left = self.set_point_ticks;
        self.motion
            .set_accepted_period(self.tick * f64::from(self.set_point_ticks));
    }

    fn report_missing_set_points(&mut self) {
        for axis in 0..self.axes.len() {
            if self.axes[axis].lacks_set_point() {
                self.set_axis_error(axis, Violation::from_code(ErrorCode::SET_POINT_MISSING));
            }
        }
        self.begin_braking();
    }

    /// Rejects the set-points of this tick, which only a part of the moving axes has while the arm brakes as a whole.
    fn reject_while_braking(&mut self) {
        for axis in 0..self.axes.len() {
            if self.axes[axis].staged.is_some() {
                self.set_axis_error(axis, Violation::from_code(ErrorCode::BRAKING));
            }
        }
        self.drop_staged();
    }

    fn drop_staged(&mut self) {
        self.axes.iter_mut().for_each(|axis| axis.staged = None);
    }

    fn begin_braking(&mut self) {
        self.drop_staged();
        if self.brake.is_none() && self.is_moving() {
            let states = self.axes.iter().map(|axis| (axis.commanded, &axis.limits));
            self.brake = Some(Brake::new(states));
            if self.ticks_left == 0 {
                let commanded = self.commanded(|state| state.position);
                self.motion.begin_braking(&commanded, self.time);
            }
            self.ticks_left = 0;
        }
    }

    fn move_braking(&mut self) {
        let Some(brake) = self.brake.as_mut() else {
            return;
        };
        let tick = self.tick;
        self.motion.set_accepted_period(tick);
        let over = if let Some(joints) = self.motion.advance_brake(tick) {
            let axes = self.axes.iter_mut().zip(joints);
            axes.for_each(|(axis, joint)| axis.brake_to(joint, tick));
            self.motion.brake_is_finished()
        } else {
            let axes = self.axes.iter_mut().zip(brake.advance(tick));
            axes.for_each(|(axis, velocity)| axis.move_braking(velocity, tick));
            brake.is_finished(tick)
        };
        self.report_range_violations();
        if over {
            self.brake = None;
            self.motion.end_braking();
            self.axes.iter_mut().for_each(Axis::apply_set_point);
        }
    }

    /// Reports axes that leave their ranges while braking, which braking cannot prevent.
    fn report_range_violations(&mut self) {
        for axis in 0..self.axes.len() {
            let (range, at) = (self.axes[axis].limits.position, self.axes[axis].driven);
            if self.enforced.position && !range.contains(at) && !self.axes[axis].code.is_failure() {
                let limit = if at > range.upper {
                    range.upper
                } else {
                    range.lower
                };
                let code = ErrorCode::POSITION;
                self.set_axis_error(
                    axis,
                    Violation {
                        code,
                        value: at,
                        limit,
                    },
                );
            }
        }
    }

    fn drive(&mut self) {
        let left = self.ticks_left;
        self.axes.iter_mut().for_each(|axis| axis.drive(left));
        self.ticks_left = left.saturating_sub(1);
    }

    /// True if the arm moves or has not reached its last set-point. A set-point of this tick takes precedence over the
    /// present velocity: a set-point at the present position brings an axis to rest.
    pub(crate) fn is_moving(&self) -> bool {
        let moves = |axis: &Axis| axis.staged.unwrap_or(axis.commanded).is_moving();
        self.brake.is_some() || self.ticks_left > 0 || self.axes.iter().any(moves)
    }

    /// True if the arm or one of its joints has failed.
    pub(super) fn has_failed(&self) -> bool {
        self.code.is_failure() || self.axes.iter().any(|axis| axis.code.is_failure())
    }

    /// Computes the effects of the simulated faults that are active now.
    pub(super) fn update_faults(&mut self) {
        let surface = self.faults.surface;
        let force = surface.map(|surface| surface.force(self.pose().translation.z));
        let failures = self.faults.update(self.time, force);
        self.update_failures(failures.whole, &failures.axes);
    }

    /// Sets and clears the failures of the arm as a whole (`whole`) and of its axes (`failed`). Each new failure is
    /// reported once.
    fn update_failures(&mut self, whole: ErrorCode, failed: &[bool]) {
        if whole != self.code && whole != ErrorCode::OK {
            self.report(None, Violation::from_code(whole));
        }
        self.code = whole;
        for (axis, failed) in failed.iter().enumerate().take(self.axes.len()) {
            let was = self.axes[axis].code == ErrorCode::JOINT_FAILED;
            match (was, failed) {
                (false, true) => {
                    self.set_axis_error(axis, Violation::from_code(ErrorCode::JOINT_FAILED))
                }
                (true, false) => self.axes[axis].code = ErrorCode::OK,
                _ => {}
            }
        }
    }

    /// Sets the error code of an axis, counted from 0, and reports it if it is new.
    pub(super) fn set_axis_error(&mut self, axis: usize, violation: Violation) {
        if self.axes[axis].code != violation.code {
            self.report(Some(axis), violation);
        }
        self.axes[axis].code = violation.code;
    }

    pub(super) fn report(&mut self, axis: Option<usize>, violation: Violation) {
        let Violation { code, value, limit } = violation;
        self.reports.push(Report {
            time: self.time,
            axis,
            code,
            value,
            limit,
        });
    }
}
