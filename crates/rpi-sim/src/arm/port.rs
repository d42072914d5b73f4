//! Access to the arm's ports: reading sensors, checking and staging set-points, calling functions.

use super::guard::{State, Violation};
use super::table::{Act, Line, PORTS, Parameter, Target};
use super::{Arm, PARAMETERS};
use crate::cell::Enforced;
use crate::code::Code;
use crate::device::{Device, Put, Report, Slot, find, pose_from, spelled_out, within};
use crate::fault::Fault;
use core::ops::Range;
use rpi_device::{Jump, PortName, Quantity, Refusal, ResolveError};
use rpi_kin::{MAX_AXES, NoSolution};

impl Arm {
    fn line(slot: Slot) -> Option<&'static Line> {
        PORTS.get(usize::from(slot.line))
    }

    /// Checks a set-point of one axis or of all. Returns the resulting states, `None` for axes that it does not set;
    /// the error names the axis.
    fn judge(
        &self,
        target: Target,
        index: usize,
        value: &[u64],
        enforced: Enforced,
    ) -> Result<Staged, (Option<usize>, Violation)> {
        let mut staged: Staged = [None; MAX_AXES];
        let mut stage = |axis: usize, position: f64| {
            let period = self.tick * f64::from(self.pace);
            let judged = self.axes[axis].judge(position, period, enforced);
            staged[axis] = Some(judged.map_err(|violation| (Some(axis), violation))?);
            Ok(())
        };
        let real = |at: usize| value.get(at).map_or(f64::NAN, |bits| f64::from_bits(*bits));
        match target {
            Target::Joint => stage(index, real(0))?,
            Target::Joints => (0..self.axes()).try_for_each(|axis| stage(axis, real(axis)))?,
            Target::Tool => {
                let joints = self.commanded(|state| state.position);
                let near = &joints[..self.axes()];
                let found = self.inverse(&pose_from(value), near, near);
                let found = found.map_err(|why| (None, Violation::of(code_of(why))))?;
                (0..self.axes()).try_for_each(|axis| stage(axis, found[axis]))?;
            }
        }
        Ok(staged)
    }

    fn check_motion(&mut self, target: Target, index: usize, value: &[u64]) -> Refusal {
        if target != Target::Joint && self.has_failed()
            || self.code.is_failure()
            || self.joint_failed(index)
        {
            return Refusal::DEVICE_FAILED;
        }
        match self.judge(target, index, value, self.enforced) {
            Ok(staged) if self.is_held_by_brake(&staged) => Refusal::DEVICE_FAILED,
            Ok(staged) => {
                self.absolve(&staged);
                Refusal::NONE
            }
            Err((Some(axis), violation)) => {
                self.blame(axis, violation);
                Refusal::ILLEGAL_VALUE
            }
            Err((None, violation)) => {
                if self.pose_code != violation.code {
                    self.report(None, violation);
                }
                self.pose_code = violation.code;
                Refusal::ILLEGAL_VALUE
            }
        }
    }

    /// True if the arm brakes as a whole and has reported this for one of the axes in `staged`.
    fn is_held_by_brake(&self, staged: &Staged) -> bool {
        let mut axes = self.axes.iter().zip(staged);
        self.brake.is_some() && axes.any(|(axis, s)| s.is_some() && axis.code == Code::BRAKING)
    }

    fn joint_failed(&self, axis: usize) -> bool {
        self.axes
            .get(axis)
            .is_some_and(|axis| axis.code.is_failure())
    }

    /// Clears the errors of rejected set-points on these axes.
    fn absolve(&mut self, staged: &Staged) {
        self.pose_code = Code::OK;
        let axes = self.axes.iter_mut().zip(staged);
        let set = axes.filter(|(_, staged)| staged.is_some());
        set.for_each(|(axis, _)| axis.forget_refusal());
    }

    /// Error code of the arm as a whole, or of the axis.
    pub(super) fn axis_code(&self, axis: usize) -> Code {
        if self.code == Code::OK {
            self.axes.get(axis).map_or(Code::OK, |axis| axis.code)
        } else {
            self.code
        }
    }

    /// Error code of the arm, of one of its axes, or of the last pose set-point.
    pub(super) fn any_code(&self) -> Code {
        if self.code() == Code::OK {
            self.pose_code
        } else {
            self.code()
        }
    }

    /// True if the arm accepts a parameter: finite numbers, no negative mass, a known control strategy.
    fn takes(&self, parameter: Parameter, value: &[u64]) -> bool {
        let first = value.first().copied().unwrap_or_default();
        let finite = value.iter().all(|bits| f64::from_bits(*bits).is_finite());
        match parameter {
            Parameter::Strategy => matches!(first, 10 | 20 | 30),
            Parameter::Tool | Parameter::ToolAndTcp => finite && f64::from_bits(first) >= 0.0,
            _ => finite,
        }
    }

    fn keep(&mut self, parameter: Parameter, index: usize, value: &[u64]) {
        if let Parameter::Strategy = parameter {
            self.strategy = value
                .first()
                .map_or(self.strategy, |bits| bits.cast_signed());
            return;
        }
        if let Some(kept) = self.parameters.get_mut(place(parameter, index)) {
            for (k, slot) in kept.iter_mut().enumerate() {
                let k = match parameter {
                    Parameter::ToolAndTcp => LOAD.get(k).copied(),
                    _ => Some(k),
                };
                let bits = k.and_then(|k| value.get(k));
                *slot = bits.map_or(*slot, |bits| f64::from_bits(*bits));
            }
        }
    }

    /// The requested control strategy: 10 position, 20 Cartesian impedance, 30 joint impedance.
    #[must_use]
    pub fn strategy(&self) -> i64 {
        self.strategy
    }

    /// The requested tool load: mass (kg), centre of mass (m), moments of inertia (kg m²), tool centre point (m).
    #[must_use]
    pub fn load(&self) -> &[f64] {
        &self.parameters[place(Parameter::Tool, 0)][..10]
    }
}

/// Indices of the numbers of [`Arm::load`] in a value of `tool_and_tcp`: mass, centre of mass as a pose, moments of
/// inertia, tool centre point as a pose. Only the positions of the poses are used.
const LOAD: [usize; 10] = [0, 1, 2, 3, 8, 9, 10, 11, 12, 13];

/// States of the axes that a set-point sets.
type Staged = [Option<State>; MAX_AXES];

/// Index of a parameter's values; also its resource number after those of the axes.
fn place(parameter: Parameter, index: usize) -> usize {
    match parameter {
        Parameter::Tool | Parameter::ToolAndTcp => 0,
        Parameter::ToolImpedance => 1,
        Parameter::ToolSine => 2,
        Parameter::JointImpedance => 3 + index,
        Parameter::Strategy => PARAMETERS,
    }
}

/// Limits for the continuity check at a takeover. Jerk is excluded: it would need a third earlier set-point.
const SMOOTH: Enforced = Enforced {
    position: true,
    velocity: true,
    acceleration: true,
    jerk: false,
};

fn quantity_of(code: Code) -> Option<Quantity> {
    match code {
        Code::POSITION => Some(Quantity::Position),
        Code::VELOCITY | Code::DISCONTINUITY => Some(Quantity::Velocity),
        Code::ACCELERATION => Some(Quantity::Acceleration),
        _ => None,
    }
}

fn code_of(why: NoSolution) -> Code {
    match why {
        NoSolution::OutOfReach => Code::OUT_OF_REACH,
        NoSolution::OutOfLimits | NoSolution::NoClosedForm => Code::NO_JOINTS,
        NoSolution::NotFinite => Code::NOT_A_NUMBER,
    }
}

impl Device for Arm {
    fn resolve(&self, name: &PortName<'_>) -> Result<Slot, ResolveError> {
        let heads = PORTS.iter().map(|line| &line.head);
        let plain = spelled_out(name.port).map_or(*name, |(port, index)| PortName {
            port,
            index,
            ..*name
        });
        find(heads, &plain, |_| self.axes())
    }

    fn has(&self, slot: Slot) -> bool {
        within(Self::line(slot).map(|line| &line.head), slot, |_| {
            self.axes()
        })
    }

    fn resources_of(&self, slot: Slot) -> Range<u32> {
        let index = usize::from(slot.index);
        let range = match Self::line(slot).map(|line| &line.act) {
            Some(Act::Move(Target::Joint)) => index..index + 1,
            Some(Act::Move(_)) => 0..self.axes(),
            Some(Act::Parameter(parameter)) => {
                let own = MAX_AXES + place(*parameter, index);
                own..own + 1
            }
            _ => 0..0,
        };
        range.start as u32..range.end as u32
    }

    fn read(&self, slot: Slot, value: &mut [u64]) -> bool {
        let Some(Act::Sense(sense)) = Self::line(slot).map(|line| &line.act) else {
            return false;
        };
        sense(self, usize::from(slot.index), &mut Put::into(value));
        !self.state.samples_lost
    }

    fn check(&mut self, slot: Slot, value: &[u64]) -> Refusal {
        match Self::line(slot).map(|line| &line.act) {
            Some(Act::Move(target)) => self.check_motion(*target, usize::from(slot.index), value),
            Some(Act::Parameter(_)) if self.has_failed() => Refusal::DEVICE_FAILED,
            Some(Act::Parameter(parameter)) if self.takes(*parameter, value) => Refusal::NONE,
            _ => Refusal::ILLEGAL_VALUE,
        }
    }

    fn jump(&self, slot: Slot, value: &[u64]) -> Option<Jump> {
        let Some(Act::Move(target)) = Self::line(slot).map(|line| &line.act) else {
            return None;
        };
        let judged = self.judge(*target, usize::from(slot.index), value, SMOOTH);
        let (axis, Violation { code, value, limit }) = judged.err()?;
        Some(Jump {
            resource: axis? as u32,
            quantity: quantity_of(code)?,
            value,
            limit,
        })
    }

    fn error(&self, slot: Slot) -> i64 {
        let code = match Self::line(slot).map(|line| &line.act) {
            Some(Act::Move(Target::Joint)) => self.axis_code(usize::from(slot.index)),
            Some(Act::Move(_)) => self.any_code(),
            _ => self.code,
        };
        code.0
    }

    fn write(&mut self, slot: Slot, value: &[u64]) {
        let index = usize::from(slot.index);
        match Self::line(slot).map(|line| &line.act) {
            Some(Act::Move(target)) => {
                // Checked again, because `write` does not rely on an earlier call of `check`.
                let staged = self
                    .judge(*target, index, value, self.enforced)
                    .unwrap_or_default();
                let set = self
                    .axes
                    .iter_mut()
                    .zip(staged)
                    .filter(|(_, staged)| staged.is_some());
                set.for_each(|(axis, staged)| axis.staged = staged);
            }
            Some(Act::Parameter(parameter)) if self.takes(*parameter, value) => {
                self.keep(*parameter, index, value)
            }
            _ => {}
        }
    }

    fn call(&self, slot: Slot, arguments: &[u64], result: &mut [u64]) -> bool {
        match Self::line(slot).map(|line| &line.act) {
            Some(Act::Call(function)) => function(self, arguments, &mut Put::into(result)),
            _ => false,
        }
    }

    fn moving(&self, resource: u32) -> bool {
        (resource as usize) < self.axes() && self.is_moving()
    }

    fn stop(&mut self, resource: u32) {
        self.told_to_stop |= (resource as usize) < self.axes();
    }

    fn begin(&mut self, resource: u32, ticks: u32) {
        if let Some(axis) = self.axes.get_mut(resource as usize) {
            axis.forget_refusal();
            self.pose_code = Code::OK;
            self.pace = ticks.max(1);
        }
    }

    fn step(&mut self, time: f64) {
        Self::step(self, time);
    }

    fn inject(&mut self, fault: Fault) -> bool {
        Self::inject(self, fault);
        true
    }

    fn code(&self) -> Code {
        self.any_code()
    }

    fn reports(&mut self, each: &mut dyn FnMut(Report)) -> u64 {
        self.reports.drain(..).for_each(each);
        core::mem::take(&mut self.reports_lost)
    }
}
