//! A mobile base with two driven wheels (differential drive).
//!
//! It accepts velocities in its own frame: x forwards, rotation counter-clockwise. It rejects velocities that a
//! differential drive cannot follow. Without set-points it brakes along its current arc.

use crate::bank::CellDevice;
use crate::cell::BaseSpec;
use crate::device::{
    Device, PortIndex, PortRow, Report, SlotWriter, find_port, is_actuator, is_in_row, read_port,
    real_at,
};
use crate::error_code::ErrorCode;
use core::ops::Range;
use rpi_device::{Discontinuity, PortQuery, Quantity, Rejection, ResolveError};
use rpi_image::Scalar;
use rpi_kin::Pose;

/// Mobile base with two driven wheels of a simulated cell.
#[derive(Clone, Debug)]
pub(crate) struct Base {
    spec: BaseSpec,
    tick: f64,
    time: f64,
    /// Number of ticks between two set-points of the running command.
    set_point_ticks: u32,
    /// Number of ticks until the next set-point is due.
    ticks_left: u32,
    /// Position in the cell: x, y (m), heading (rad).
    position: [f64; 3],
    /// Forward velocity (m/s) and angular velocity (rad/s).
    velocity: [f64; 2],
    staged: Option<[f64; 2]>,
    /// Number of successive periods without a set-point so far.
    missed_periods: u32,
    braking: bool,
    /// Angles of the left and the right wheel, in rad.
    wheels: [f64; 2],
    code: ErrorCode,
    reports: Vec<Report>,
    /// Number of reports since the last reading for which there was no room.
    lost_reports: u64,
}

/// Maximum number of reports that wait until they are read.
const REPORT_CAPACITY: usize = 16;

/// Velocity in m/s or rad/s up to which the base counts as at rest.
const REST_VELOCITY: f64 = 1e-6;

const PORTS: &[PortRow<Base>] = &[
    PortRow::sensor("base.position", Scalar::Pose, |base, _, out| {
        out.put_pose(&base.pose())
    }),
    PortRow::sensor("base.commanded_velocity", Scalar::Twist, Base::put_velocity),
    PortRow::sensor("base.measured_velocity", Scalar::Twist, Base::put_velocity),
    PortRow::sensor("base.error", Scalar::Int, |base, _, out| {
        out.put_bits(base.code.0.cast_unsigned())
    }),
    PortRow::sensor("wheel.position", Scalar::Real, Base::put_wheel).indexed(),
    PortRow::sensor("wheel.velocity", Scalar::Real, Base::put_wheel_velocity).indexed(),
    PortRow::actuator("base.velocity", Scalar::Twist),
    // Ports of the device type `MobileBase` of `.rpi`.
    PortRow::sensor("pose", Scalar::Pose, |base, _, out| {
        out.put_pose(&base.pose())
    }),
    PortRow::sensor("twist", Scalar::Twist, Base::put_velocity),
    PortRow::sensor("error", Scalar::Bool, |base, _, out| {
        out.put_bits(u64::from(base.code != ErrorCode::OK))
    }),
    PortRow::sensor("code", Scalar::Int, |base, _, out| {
        out.put_bits(base.code.0.cast_unsigned())
    }),
    PortRow::actuator("velocity", Scalar::Twist),
];

/// Returns the descriptions of the ports of a mobile base, for the manual.
pub(crate) fn ports() -> impl Iterator<Item = crate::device::PortInfo> {
    PORTS.iter().map(|line| line.spec.info())
}

impl Base {
    pub(crate) fn new(spec: &BaseSpec, tick: f64) -> Self {
        Self {
            spec: spec.clone(),
            tick,
            time: 0.0,
            set_point_ticks: 1,
            ticks_left: 0,
            position: spec.position,
            velocity: [0.0; 2],
            staged: None,
            missed_periods: 0,
            braking: false,
            wheels: [0.0; 2],
            code: ErrorCode::OK,
            reports: Vec::with_capacity(REPORT_CAPACITY),
            lost_reports: 0,
        }
    }

    fn pose(&self) -> Pose {
        let [x, y, heading] = self.position;
        let (sin, cos) = rpi_math::sincos(heading / 2.0);
        let turn = nalgebra::Quaternion::new(cos, 0.0, 0.0, sin);
        Pose::from_parts(
            nalgebra::Translation3::new(x, y, 0.0),
            nalgebra::UnitQuaternion::new_unchecked(turn),
        )
    }

    fn put_velocity(&self, _: usize, out: &mut SlotWriter<'_>) {
        let [forwards, turning] = self.velocity;
        out.put_reals([forwards, 0.0, 0.0, 0.0, 0.0, turning]);
    }

    fn put_wheel(&self, wheel: usize, out: &mut SlotWriter<'_>) {
        out.put_reals(self.wheels.get(wheel).copied());
    }

    fn put_wheel_velocity(&self, wheel: usize, out: &mut SlotWriter<'_>) {
        out.put_reals(self.wheel_velocities().get(wheel).copied());
    }

    /// Returns the angular velocities of the left and the right wheel, in rad/s.
    fn wheel_velocities(&self) -> [f64; 2] {
        let [forwards, turning] = self.velocity;
        [-0.5, 0.5]
            .map(|side| (forwards + side * self.spec.track * turning) / self.spec.wheel_radius)
    }

    /// True while the base moves. A set-point of this tick takes precedence over the present velocity.
    fn is_moving(&self) -> bool {
        let velocity = self.staged.unwrap_or(self.velocity);
        velocity.iter().any(|part| part.abs() > REST_VELOCITY)
    }

    /// Returns the forward (m/s) and angular velocity (rad/s) that a set-point requests. If it is rejected, returns the
    /// error code, the value and the violated limit.
    fn check_set_point(&self, value: &[u64]) -> Result<[f64; 2], (ErrorCode, f64, f64)> {
        let part = |at: usize| real_at(value, at);
        let wanted = [part(0), part(5)];
        let aside = [1, 2, 3, 4]
            .map(part)
            .into_iter()
            .find(|part| part.abs() > REST_VELOCITY || part.is_nan());
        if let Some(bad) = wanted
            .into_iter()
            .chain(aside)
            .find(|part| !part.is_finite())
        {
            return Err((ErrorCode::NOT_A_NUMBER, bad, 0.0));
        }
        if let Some(aside) = aside {
            return Err((ErrorCode::NOT_DRIVABLE, aside, 0.0));
        }
        for (axis, (wanted, now)) in wanted.into_iter().zip(self.velocity).enumerate() {
            let (most, fastest) = (self.spec.velocity[axis], self.spec.acceleration[axis]);
            let acceleration = (wanted - now) / (self.tick * f64::from(self.set_point_ticks));
            if wanted.abs() > most * (1.0 + 1e-6) {
                return Err((ErrorCode::VELOCITY, wanted, most));
            }
            if acceleration.abs() > fastest * (1.0 + 1e-6) {
                return Err((ErrorCode::ACCELERATION, acceleration, fastest));
            }
        }
        Ok(wanted)
    }

    fn set_error(&mut self, code: ErrorCode, value: f64, limit: f64) {
        if self.code != code && self.reports.len() == REPORT_CAPACITY {
            self.lost_reports += 1;
        } else if self.code != code {
            self.reports.push(Report {
                time: self.time,
                axis: None,
                code,
                value,
                limit,
            });
        }
        self.code = code;
    }

    /// Applies the set-point of this tick; without one, the base continues or begins to brake.
    fn decide(&mut self) {
        if let Some(velocity) = self.staged.take() {
            (self.velocity, self.ticks_left, self.braking) =
                (velocity, self.set_point_ticks, false);
            self.missed_periods = 0;
        } else if self.ticks_left == 0 && self.is_moving() && !self.braking {
            self.miss_set_point();
        }
        self.ticks_left = self.ticks_left.saturating_sub(1);
        if self.braking {
            self.slow_down();
        }
    }

    /// Continues with the present velocity for a period without a set-point, or begins to brake if the watchdog allows
    /// no further period.
    fn miss_set_point(&mut self) {
        self.missed_periods += 1;
        if self.missed_periods < self.spec.watchdog {
            self.ticks_left = self.set_point_ticks;
            return;
        }
        self.set_error(ErrorCode::SET_POINT_MISSING, 0.0, 0.0);
        self.braking = true;
    }

    /// Reduces forward and angular velocity by the same factor, so that the radius of the arc does not change.
    fn slow_down(&mut self) {
        let both = self.velocity.iter().zip(self.spec.acceleration);
        let share = both
            .map(|(velocity, most)| most * self.tick / velocity.abs())
            .fold(1.0, f64::min);
        self.velocity = self.velocity.map(|velocity| velocity * (1.0 - share));
        self.braking = self.is_moving();
        if !self.braking {
            self.velocity = [0.0; 2];
        }
    }

    /// Moves the base by one tick along its arc.
    fn drive(&mut self) {
        let [forwards, turning] = self.velocity.map(|velocity| velocity * self.tick);
        let half = turning / 2.0;
        // Ratio of chord to arc, sin(h) / h; the Taylor series avoids 0 / 0.
        let chord = if half.abs() < 1e-6 {
            1.0 - half * half / 6.0
        } else {
            rpi_math::sin(half) / half
        };
        let (sin, cos) = rpi_math::sincos(self.position[2] + half);
        self.position[0] += forwards * chord * cos;
        self.position[1] += forwards * chord * sin;
        self.position[2] = rpi_kin::angle::wrap(self.position[2] + turning);
        let turning = self.wheel_velocities();
        self.wheels
            .iter_mut()
            .zip(turning)
            .for_each(|(wheel, turning)| *wheel += turning * self.tick);
    }
}

impl CellDevice for Base {}

impl Device for Base {
    fn resolve(&self, name: &PortQuery<'_>) -> Result<PortIndex, ResolveError> {
        find_port(PORTS.iter().map(|line| &line.spec), name, |_| 2)
    }

    fn has_port(&self, slot: PortIndex) -> bool {
        let line = PORTS.get(usize::from(slot.row));
        is_in_row(line.map(|line| &line.spec), slot, |_| 2)
    }

    fn resources(&self, slot: PortIndex) -> Range<u32> {
        0..u32::from(is_actuator(PORTS, slot))
    }

    fn read(&self, slot: PortIndex, value: &mut [u64]) -> bool {
        read_port(PORTS, self, slot, value)
    }

    fn check(&mut self, slot: PortIndex, value: &[u64]) -> Rejection {
        match self.check_set_point(value) {
            Ok(_) if is_actuator(PORTS, slot) => {
                self.code = ErrorCode::OK;
                Rejection::NONE
            }
            Ok(_) => Rejection::ILLEGAL_VALUE,
            Err((code, value, limit)) => {
                self.set_error(code, value, limit);
                Rejection::ILLEGAL_VALUE
            }
        }
    }

    fn discontinuity(&self, _slot: PortIndex, value: &[u64]) -> Option<Discontinuity> {
        let (code, value, limit) = self.check_set_point(value).err()?;
        let quantity = match code {
            ErrorCode::VELOCITY => Quantity::Velocity,
            ErrorCode::ACCELERATION => Quantity::Acceleration,
            _ => return None,
        };
        Some(Discontinuity {
            resource: 0,
            quantity,
            value,
            limit,
        })
    }

    fn port_code(&self, _slot: PortIndex) -> ErrorCode {
        self.code
    }

    fn write(&mut self, slot: PortIndex, value: &[u64]) {
        if is_actuator(PORTS, slot) {
            self.staged = self.check_set_point(value).ok();
        }
    }

    fn is_moving(&self, _resource: u32) -> bool {
        self.is_moving()
    }

    fn stop(&mut self, _resource: u32) {
        self.staged = None;
        self.braking = self.is_moving();
    }

    fn begin_command(&mut self, _resource: u32, ticks: u32) {
        self.set_point_ticks = ticks.max(1);
        self.code = ErrorCode::OK;
    }

    fn step(&mut self, time: f64) {
        self.time = time;
        self.decide();
        self.drive();
    }

    fn code(&self) -> ErrorCode {
        self.code
    }

    fn reports(&mut self, each: &mut dyn FnMut(Report)) -> u64 {
        self.reports.drain(..).for_each(each);
        std::mem::take(&mut self.lost_reports)
    }
}
