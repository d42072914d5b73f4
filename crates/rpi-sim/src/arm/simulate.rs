//! Simulation of an arm from tick to tick.

use super::axis::Axis;
use super::brake::Brake;
use super::guard::Violation;
use super::{Arm, REPORTS, Troubles, sample_of};
use crate::code::Code;
use crate::device::Report;
use crate::fault::Trouble;

impl Arm {
    /// Simulates one tick that ends at `time` (s): applies set-points, moves the drives, takes samples.
    pub fn step(&mut self, time: f64) {
        self.time = time;
        self.weather();
        if self.state.set_points_lost {
            self.drop_staged();
        }
        self.decide();
        if self.brake.is_some() {
            self.coast();
        } else {
            self.drive();
        }
        self.sense();
    }

    /// Decides what happens in this tick: follow set-points, brake, or stand still.
    fn decide(&mut self) {
        let told = core::mem::take(&mut self.told_to_stop);
        if told || self.has_failed() {
            return self.begin_braking();
        }
        let came = self.axes.iter().any(|axis| axis.staged.is_some());
        let left_alone = self.axes.iter().any(Axis::is_left_alone);
        // The tuple: some axis has a set-point, some moving axis has none, the arm brakes.
        match (came, left_alone, self.brake.is_some()) {
            (true, false, _) => self.take_set_points(),
            (true, true, true) => self.refuse_to_leave_brake(),
            (false, _, _) if self.left > 0 => {}
            (_, true, false) => self.miss_set_points(),
            (false, false, false) => self.axes.iter_mut().for_each(Axis::take),
            (false, _, true) => {}
        }
    }

    fn take_set_points(&mut self) {
        self.brake = None;
        self.axes.iter_mut().for_each(Axis::take);
        self.left = self.pace;
    }

    fn miss_set_points(&mut self) {
        for axis in 0..self.axes.len() {
            if self.axes[axis].is_left_alone() {
                self.blame(axis, Violation::of(Code::SET_POINT_MISSING));
            }
        }
        self.begin_braking();
    }

    /// Rejects set-points for a part of the moving axes while the arm brakes as a whole.
    fn refuse_to_leave_brake(&mut self) {
        for axis in 0..self.axes.len() {
            if self.axes[axis].staged.is_some() {
                self.blame(axis, Violation::of(Code::BRAKING));
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
            self.left = 0;
        }
    }

    fn coast(&mut self) {
        let Some(brake) = self.brake.as_mut() else {
            return;
        };
        for (axis, velocity) in self.axes.iter_mut().zip(brake.pass(self.tick)) {
            axis.coast(velocity, self.tick);
        }
        let over = brake.is_over(self.tick);
        self.watch_ranges();
        if over {
            self.brake = None;
            self.axes.iter_mut().for_each(Axis::take);
        }
    }

    /// Reports axes that leave their range while braking. Braking cannot prevent this.
    fn watch_ranges(&mut self) {
        for axis in 0..self.axes.len() {
            let (range, at) = (self.axes[axis].limits.position, self.axes[axis].driven);
            if self.enforced.position && !range.contains(at) && !self.axes[axis].code.is_failure() {
                let limit = if at > range.upper {
                    range.upper
                } else {
                    range.lower
                };
                let code = Code::POSITION;
                self.blame(
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
        let left = self.left;
        self.axes.iter_mut().for_each(|axis| axis.drive(left));
        self.left = left.saturating_sub(1);
    }

    fn sense(&mut self) {
        let (share, tick) = (self.share, self.tick);
        self.axes
            .iter_mut()
            .for_each(|axis| axis.measure(share, tick));
        let mut sample = sample_of(&self.axes);
        let deviation = self.deviation + self.state.deviation;
        for axis in sample.iter_mut().take(self.axes.len()) {
            axis.position += self.noise.normal(deviation);
        }
        let age = self.ticks(self.latency + self.state.delay);
        self.history.add(sample, age);
    }

    /// True if the arm moves or has not reached its last set-point. A staged set-point takes precedence over the
    /// present velocity: a set-point at the present position brings an axis to rest.
    pub(super) fn is_moving(&self) -> bool {
        let moves = |axis: &Axis| axis.staged.unwrap_or(axis.commanded).is_moving();
        self.brake.is_some() || self.left > 0 || self.axes.iter().any(moves)
    }

    /// True if the arm or one of its joints has failed.
    pub(super) fn has_failed(&self) -> bool {
        self.code.is_failure() || self.axes.iter().any(|axis| axis.code.is_failure())
    }

    /// Computes the effects of the faults that are active now.
    pub(super) fn weather(&mut self) {
        self.state = Troubles::default();
        let mut whole = Code::OK;
        let mut failed = [false; rpi_kin::MAX_AXES];
        for fault in self.faults.iter().filter(|fault| fault.is_on(self.time)) {
            match fault.trouble {
                Trouble::JointFailure(axis) => failed
                    .get_mut(axis)
                    .into_iter()
                    .for_each(|axis| *axis = true),
                Trouble::EmergencyStop => whole = Code::EMERGENCY_STOP,
                Trouble::LostSamples => self.state.samples_lost = true,
                Trouble::LostSetPoints => self.state.set_points_lost = true,
                Trouble::Latency(delay) => self.state.delay += delay,
                Trouble::Noise(deviation) => self.state.deviation += deviation,
                Trouble::Contact(wrench) => self.state.contact += wrench,
            }
        }
        if let Some(surface) = self.surface {
            // Component 2 is the force along z.
            self.state.contact[2] += surface.push(self.pose().translation.z);
        }
        self.fail(whole, &failed);
    }

    /// Sets and clears failures. Each new failure is reported once.
    fn fail(&mut self, whole: Code, failed: &[bool]) {
        if whole != self.code && whole != Code::OK {
            self.report(None, Violation::of(whole));
        }
        self.code = whole;
        for (axis, failed) in failed.iter().enumerate().take(self.axes.len()) {
            let was = self.axes[axis].code == Code::JOINT_FAILED;
            match (was, failed) {
                (false, true) => self.blame(axis, Violation::of(Code::JOINT_FAILED)),
                (true, false) => self.axes[axis].code = Code::OK,
                _ => {}
            }
        }
    }

    /// Sets the error code of an axis. Reports it if it is new.
    pub(super) fn blame(&mut self, axis: usize, violation: Violation) {
        if self.axes[axis].code != violation.code {
            self.report(Some(axis), violation);
        }
        self.axes[axis].code = violation.code;
    }

    pub(super) fn report(&mut self, axis: Option<usize>, violation: Violation) {
        if self.reports.len() == REPORTS {
            self.reports_lost += 1;
            return;
        }
        let Violation { code, value, limit } = violation;
        self.reports.push(Report {
            time: self.time,
            axis,
            code,
            value,
            limit,
        });
    }

    /// Reserves space for the largest latency that any fault may cause.
    pub(super) fn make_room(&mut self) {
        let delays = self.faults.iter().map(|fault| match fault.trouble {
            Trouble::Latency(delay) => delay,
            _ => 0.0,
        });
        let oldest = self.ticks(self.latency + delays.sum::<f64>());
        self.history.reserve(oldest);
    }

    fn ticks(&self, time: f64) -> usize {
        // The conversion saturates. Times are never negative, and the history limits the age.
        (time / self.tick).ceil() as usize
    }
}
