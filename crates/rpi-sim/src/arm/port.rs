//! Access to the arm's ports: reading sensors, checking and staging set-points, calling functions.

use super::follower::call_follow_pose;
use super::limit_usage::AxisUsage;
use super::limits::{AxisState, Violation};
use super::motion::{call_path_event, report_missed_events};
use super::port_table::{PORTS, PortAction, PortRow, Target};
use super::{Arm, parameters};
use crate::bank::CellDevice;
use crate::cell::EnforcedLimits;
use crate::device::{
    Device, PortIndex, Report, SlotWriter, find_port, is_in_row, pose_from, real_at,
    split_numbered_name,
};
use crate::error_code::ErrorCode;
use crate::fault::ScheduledFault;
use core::ops::Range;
use rpi_device::{Discontinuity, PortQuery, Quantity, Rejection, ResolveError};
use rpi_kin::{InverseKinematicsError, MAX_AXES};

impl Arm {
    /// Checks a set-point, given as slots, for one axis (`index`), for all axes or for the tool. Returns the states of
    /// the axes that it leads to; the error names the axis, `None` for the whole arm.
    fn check_set_point(
        &self,
        target: Target,
        index: usize,
        value: &[u64],
        enforced: EnforcedLimits,
    ) -> Result<StagedStates, (Option<usize>, Violation)> {
        let mut staged: StagedStates = [None; MAX_AXES];
        let mut stage = |axis: usize, position: f64| {
            let period = self.tick * f64::from(self.set_point_ticks);
            let judged = self.axes[axis].check_set_point(position, period, enforced);
            staged[axis] = Some(judged.map_err(|violation| (Some(axis), violation))?);
            Ok(())
        };
        match target {
            Target::Joint => stage(index, real_at(value, 0))?,
            Target::Joints => {
                (0..self.axes()).try_for_each(|axis| stage(axis, real_at(value, axis)))?
            }
            Target::Tool => {
                let joints = self.commanded(|state| state.position);
                let near = &joints[..self.axes()];
                let found = self.kinematics.inverse(&pose_from(value), near, near);
                let found =
                    found.map_err(|why| (None, Violation::from_code(inverse_error_code(why))))?;
                (0..self.axes()).try_for_each(|axis| stage(axis, found[axis]))?;
            }
        }
        Ok(staged)
    }

    fn check_motion(&mut self, target: Target, index: usize, value: &[u64]) -> Rejection {
        if target != Target::Joint && self.has_failed()
            || self.code.is_failure()
            || self.joint_failed(index)
        {
            return Rejection::DEVICE_FAILED;
        }
        match self.check_set_point(target, index, value, self.enforced) {
            Ok(staged) if self.is_rejected_by_brake(&staged) => Rejection::DEVICE_FAILED,
            Ok(staged) => {
                self.clear_rejections(&staged);
                Rejection::NONE
            }
            Err((Some(axis), violation)) => {
                self.set_axis_error(axis, violation);
                Rejection::ILLEGAL_VALUE
            }
            Err((None, violation)) => {
                if self.pose_code != violation.code {
                    self.report(None, violation);
                }
                self.pose_code = violation.code;
                Rejection::ILLEGAL_VALUE
            }
        }
    }

    /// True if the arm brakes as a whole and has reported this for one of the axes that `staged` would set.
    fn is_rejected_by_brake(&self, staged: &StagedStates) -> bool {
        let mut axes = self.axes.iter().zip(staged);
        self.brake.is_some() && axes.any(|(axis, s)| s.is_some() && axis.code == ErrorCode::BRAKING)
    }

    fn joint_failed(&self, axis: usize) -> bool {
        self.axes
            .get(axis)
            .is_some_and(|axis| axis.code.is_failure())
    }

    /// Clears the error codes of rejected set-points, for the axes that `staged` sets.
    fn clear_rejections(&mut self, staged: &StagedStates) {
        self.pose_code = ErrorCode::OK;
        let axes = self.axes.iter_mut().zip(staged);
        let set = axes.filter(|(_, staged)| staged.is_some());
        set.for_each(|(axis, _)| axis.clear_rejection());
    }

    /// Returns the error code of the arm as a whole, or else of the axis, counted from 0; 0 for none.
    pub(super) fn axis_code(&self, axis: usize) -> ErrorCode {
        if self.code == ErrorCode::OK {
            self.axes.get(axis).map_or(ErrorCode::OK, |axis| axis.code)
        } else {
            self.code
        }
    }

    /// Returns the error code of the arm or one of its axes, of the last pose set-point, or of the present motion; 0
    /// for none.
    pub(super) fn any_code(&self) -> ErrorCode {
        let codes = [self.code(), self.pose_code, self.motion.error()];
        let first = codes.into_iter().find(|code| *code != ErrorCode::OK);
        first.unwrap_or(ErrorCode::OK)
    }

    /// Returns the requested control strategy: 10 for position control, 20 for Cartesian impedance, 30 for joint
    /// impedance.
    #[must_use]
    pub fn strategy(&self) -> i64 {
        self.parameters.strategy
    }

    /// Returns the requested tool load: mass (kg), centre of mass (m), moments of inertia (kg m²), tool centre point
    /// (m); ten numbers.
    #[must_use]
    pub fn load(&self) -> &[f64] {
        self.parameters.load()
    }
}

/// Returns the row of the port table of an arm for this port; `None` if there is no such row.
fn port_row(slot: PortIndex) -> Option<&'static PortRow> {
    PORTS.get(usize::from(slot.row))
}

/// State of each axis after a set-point; `None` for an axis that the set-point does not set.
type StagedStates = [Option<AxisState>; MAX_AXES];

/// Limits for the check of continuity at a takeover. Jerk is excluded, because it would need a third earlier set-point.
const CONTINUITY_LIMITS: EnforcedLimits = EnforcedLimits {
    position: true,
    velocity: true,
    acceleration: true,
    jerk: false,
};

fn quantity_of(code: ErrorCode) -> Option<Quantity> {
    match code {
        ErrorCode::POSITION => Some(Quantity::Position),
        ErrorCode::VELOCITY | ErrorCode::DISCONTINUITY => Some(Quantity::Velocity),
        ErrorCode::ACCELERATION => Some(Quantity::Acceleration),
        _ => None,
    }
}

pub(super) fn inverse_error_code(why: InverseKinematicsError) -> ErrorCode {
    match why {
        InverseKinematicsError::OutOfReach => ErrorCode::OUT_OF_REACH,
        InverseKinematicsError::OutOfLimits | InverseKinematicsError::NoClosedForm => {
            ErrorCode::JOINTS_OUT_OF_RANGE
        }
        InverseKinematicsError::NotFinite => ErrorCode::NOT_A_NUMBER,
    }
}

impl Device for Arm {
    fn resolve(&self, name: &PortQuery<'_>) -> Result<PortIndex, ResolveError> {
        let heads = PORTS.iter().map(|line| &line.spec);
        let plain = split_numbered_name(name.port).map_or(*name, |(port, index)| PortQuery {
            port,
            index,
            ..*name
        });
        find_port(heads, &plain, |_| self.axes())
    }

    fn has_port(&self, slot: PortIndex) -> bool {
        is_in_row(port_row(slot).map(|line| &line.spec), slot, |_| self.axes())
    }

    fn resources(&self, slot: PortIndex) -> Range<u32> {
        let index = usize::from(slot.index);
        let range = match port_row(slot).map(|line| &line.action) {
            Some(PortAction::Move(Target::Joint)) => index..index + 1,
            Some(PortAction::Move(_)) => 0..self.axes(),
            Some(PortAction::Parameter(parameter)) => {
                let own = MAX_AXES + parameters::resource_index(*parameter, index);
                own..own + 1
            }
            _ => 0..0,
        };
        range.start as u32..range.end as u32
    }

    fn read(&self, slot: PortIndex, value: &mut [u64]) -> bool {
        let Some(PortAction::Sense(sense)) = port_row(slot).map(|line| &line.action) else {
            return false;
        };
        sense(self, usize::from(slot.index), &mut SlotWriter::new(value));
        !self.faults.effects.samples_lost
    }

    fn check(&mut self, slot: PortIndex, value: &[u64]) -> Rejection {
        match port_row(slot).map(|line| &line.action) {
            Some(PortAction::Move(target)) => {
                self.check_motion(*target, usize::from(slot.index), value)
            }
            Some(PortAction::Parameter(_)) if self.has_failed() => Rejection::DEVICE_FAILED,
            Some(PortAction::Parameter(parameter)) if parameters::accepts(*parameter, value) => {
                Rejection::NONE
            }
            _ => Rejection::ILLEGAL_VALUE,
        }
    }

    fn discontinuity(&self, slot: PortIndex, value: &[u64]) -> Option<Discontinuity> {
        let Some(PortAction::Move(target)) = port_row(slot).map(|line| &line.action) else {
            return None;
        };
        let judged =
            self.check_set_point(*target, usize::from(slot.index), value, CONTINUITY_LIMITS);
        let (axis, Violation { code, value, limit }) = judged.err()?;
        Some(Discontinuity {
            resource: axis? as u32,
            quantity: quantity_of(code)?,
            value,
            limit,
        })
    }

    fn port_code(&self, slot: PortIndex) -> ErrorCode {
        match port_row(slot).map(|line| &line.action) {
            Some(PortAction::Move(Target::Joint)) => self.axis_code(usize::from(slot.index)),
            Some(PortAction::Move(_)) => self.any_code(),
            _ => self.code,
        }
    }

    fn write(&mut self, slot: PortIndex, value: &[u64]) {
        let index = usize::from(slot.index);
        match port_row(slot).map(|line| &line.action) {
            Some(PortAction::Move(target)) => {
                // Checked again, because `write` does not rely on an earlier call of `check`.
                let staged = self
                    .check_set_point(*target, index, value, self.enforced)
                    .unwrap_or_default();
                let set = self
                    .axes
                    .iter_mut()
                    .zip(staged)
                    .filter(|(_, staged)| staged.is_some());
                set.for_each(|(axis, staged)| axis.staged = staged);
            }
            Some(PortAction::Parameter(parameter)) if parameters::accepts(*parameter, value) => {
                self.parameters.store(*parameter, index, value)
            }
            _ => {}
        }
    }

    fn call(&mut self, slot: PortIndex, arguments: &[u64], result: &mut [u64]) -> bool {
        match port_row(slot).map(|line| &line.action) {
            Some(PortAction::Plan(kind)) => {
                self.call_motion(*kind, arguments, &mut SlotWriter::new(result))
            }
            Some(PortAction::PathEvent) => {
                call_path_event(self, arguments, &mut SlotWriter::new(result))
            }
            Some(PortAction::FollowPose) => {
                call_follow_pose(self, arguments, &mut SlotWriter::new(result))
            }
            Some(PortAction::Call(function)) => {
                function(self, arguments, &mut SlotWriter::new(result))
            }
            _ => false,
        }
    }

    fn is_moving(&self, resource: u32) -> bool {
        (resource as usize) < self.axes() && self.is_moving()
    }

    fn stop(&mut self, resource: u32) {
        self.stop_requested |= (resource as usize) < self.axes();
    }

    fn begin_command(&mut self, resource: u32, ticks: u32) {
        if let Some(axis) = self.axes.get_mut(resource as usize) {
            axis.clear_rejection();
            self.pose_code = ErrorCode::OK;
            self.motion.clear_error();
            self.set_point_ticks = ticks.max(1);
        }
    }

    fn step(&mut self, time: f64) {
        Self::step(self, time);
    }

    fn code(&self) -> ErrorCode {
        self.any_code()
    }

    fn reports(&mut self, each: &mut dyn FnMut(Report)) -> u64 {
        self.reports.drain(each)
    }
}

impl CellDevice for Arm {
    fn inject(&mut self, fault: ScheduledFault) -> bool {
        Self::inject(self, fault);
        true
    }

    fn finish(&mut self) {
        report_missed_events(self);
    }

    fn limit_usage(&self, each: &mut dyn FnMut(AxisUsage<'_>)) {
        for (axis, own) in self.axes.iter().enumerate() {
            each(AxisUsage {
                axis,
                is_linear: self.kinematics.is_linear(axis),
                usage: &own.usage,
            });
        }
    }
}
