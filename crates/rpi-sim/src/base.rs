//! A mobile base with two driven wheels (differential drive).
//!
//! It accepts velocities in its own frame: x forwards, rotation counter-clockwise. It rejects velocities that a
//! differential drive cannot follow. Without set-points it brakes along its current arc.

use crate::cell::BaseSpec;
use crate::code::Code;
use crate::device::{Device, Line, Put, Report, Slot, find, is_actuator, tell, within};
use core::ops::Range;
use rpi_device::{Jump, PortName, Quantity, Refusal, ResolveError};
use rpi_image::Scalar;
use rpi_kin::Pose;

/// A mobile base of a simulated cell.
#[derive(Clone, Debug)]
pub(crate) struct Base {
    spec: BaseSpec,
    tick: f64,
    time: f64,
    /// Ticks between set-points, and ticks until the next one is due.
    pace: u32,
    left: u32,
    /// Pose in the cell: x, y (m), heading (rad).
    place: [f64; 3],
    /// Forward velocity (m/s) and angular velocity (rad/s).
    velocity: [f64; 2],
    staged: Option<[f64; 2]>,
    braking: bool,
    /// Angles of the wheels, left and right, in rad.
    wheels: [f64; 2],
    code: Code,
    reports: Vec<Report>,
}

/// Capacity for pending reports.
const REPORTS: usize = 16;

/// Velocities below this, in m/s or rad/s, count as zero.
const STANDING: f64 = 1e-6;

const PORTS: &[Line<Base>] = &[
    Line::sensor("base.position", Scalar::Pose, |base, _, out| {
        out.pose(&base.pose())
    }),
    Line::sensor("base.commanded_velocity", Scalar::Twist, Base::put_velocity),
    Line::sensor("base.measured_velocity", Scalar::Twist, Base::put_velocity),
    Line::sensor("base.error", Scalar::Int, |base, _, out| {
        out.bits(base.code.0.cast_unsigned())
    }),
    Line::sensor("wheel.position", Scalar::Real, Base::put_wheel).indexed(),
    Line::sensor("wheel.velocity", Scalar::Real, Base::put_wheel_velocity).indexed(),
    Line::actuator("base.velocity", Scalar::Twist),
];

/// Descriptions of a base's ports, for the manual.
pub(crate) fn ports() -> impl Iterator<Item = crate::device::PortInfo> {
    PORTS.iter().map(|line| line.head.info())
}

impl Base {
    pub(crate) fn new(spec: &BaseSpec, tick: f64) -> Self {
        Self {
            spec: spec.clone(),
            tick,
            time: 0.0,
            pace: 1,
            left: 0,
            place: spec.place,
            velocity: [0.0; 2],
            staged: None,
            braking: false,
            wheels: [0.0; 2],
            code: Code::OK,
            reports: Vec::with_capacity(REPORTS),
        }
    }

    fn pose(&self) -> Pose {
        let [x, y, heading] = self.place;
        let (sin, cos) = libm::sincos(heading / 2.0);
        let turn = nalgebra::Quaternion::new(cos, 0.0, 0.0, sin);
        Pose::from_parts(
            nalgebra::Translation3::new(x, y, 0.0),
            nalgebra::UnitQuaternion::new_unchecked(turn),
        )
    }

    fn put_velocity(&self, _: usize, out: &mut Put<'_>) {
        let [forwards, turning] = self.velocity;
        out.reals([forwards, 0.0, 0.0, 0.0, 0.0, turning]);
    }

    fn put_wheel(&self, wheel: usize, out: &mut Put<'_>) {
        out.reals(self.wheels.get(wheel).copied());
    }

    fn put_wheel_velocity(&self, wheel: usize, out: &mut Put<'_>) {
        out.reals(self.turning().get(wheel).copied());
    }

    /// Angular velocities of the wheels, left and right, in rad/s.
    fn turning(&self) -> [f64; 2] {
        let [forwards, turning] = self.velocity;
        [-0.5, 0.5]
            .map(|side| (forwards + side * self.spec.track * turning) / self.spec.wheel_radius)
    }

    /// True while the base moves. A staged set-point takes precedence over the present velocity.
    fn is_moving(&self) -> bool {
        let velocity = self.staged.unwrap_or(self.velocity);
        velocity.iter().any(|part| part.abs() > STANDING)
    }

    /// Velocity of a set-point. Returns the violated limit otherwise: code, value, limit.
    fn judge(&self, value: &[u64]) -> Result<[f64; 2], (Code, f64, f64)> {
        let part = |at: usize| value.get(at).map_or(f64::NAN, |bits| f64::from_bits(*bits));
        let wanted = [part(0), part(5)];
        let aside = [1, 2, 3, 4]
            .map(part)
            .into_iter()
            .find(|part| part.abs() > STANDING || part.is_nan());
        if let Some(bad) = wanted
            .into_iter()
            .chain(aside)
            .find(|part| !part.is_finite())
        {
            return Err((Code::NOT_A_NUMBER, bad, 0.0));
        }
        if let Some(aside) = aside {
            return Err((Code::NOT_DRIVABLE, aside, 0.0));
        }
        for (axis, (wanted, now)) in wanted.into_iter().zip(self.velocity).enumerate() {
            let (most, fastest) = (self.spec.velocity[axis], self.spec.acceleration[axis]);
            let acceleration = (wanted - now) / (self.tick * f64::from(self.pace));
            if wanted.abs() > most * (1.0 + 1e-6) {
                return Err((Code::VELOCITY, wanted, most));
            }
            if acceleration.abs() > fastest * (1.0 + 1e-6) {
                return Err((Code::ACCELERATION, acceleration, fastest));
            }
        }
        Ok(wanted)
    }

    fn blame(&mut self, code: Code, value: f64, limit: f64) {
        if self.code != code && self.reports.len() < REPORTS {
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

    /// Applies the staged set-point, continues, or starts braking.
    fn decide(&mut self) {
        if let Some(velocity) = self.staged.take() {
            (self.velocity, self.left, self.braking) = (velocity, self.pace, false);
        } else if self.left == 0 && self.is_moving() && !self.braking {
            self.blame(Code::SET_POINT_MISSING, 0.0, 0.0);
            self.braking = true;
        }
        self.left = self.left.saturating_sub(1);
        if self.braking {
            self.slow_down();
        }
    }

    /// Brakes both velocities by the same factor, so that the radius of the arc does not change.
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

    /// Integrates one tick along the arc.
    fn drive(&mut self) {
        let [forwards, turning] = self.velocity.map(|velocity| velocity * self.tick);
        let half = turning / 2.0;
        // Ratio of chord to arc, sin(h) / h; the Taylor series avoids 0 / 0.
        let chord = if half.abs() < 1e-6 {
            1.0 - half * half / 6.0
        } else {
            libm::sin(half) / half
        };
        let (sin, cos) = libm::sincos(self.place[2] + half);
        self.place[0] += forwards * chord * cos;
        self.place[1] += forwards * chord * sin;
        self.place[2] = rpi_kin::angle::wrap(self.place[2] + turning);
        let turning = self.turning();
        self.wheels
            .iter_mut()
            .zip(turning)
            .for_each(|(wheel, turning)| *wheel += turning * self.tick);
    }
}

impl Device for Base {
    fn resolve(&self, name: &PortName<'_>) -> Result<Slot, ResolveError> {
        find(PORTS.iter().map(|line| &line.head), name, |_| 2)
    }

    fn has(&self, slot: Slot) -> bool {
        let line = PORTS.get(usize::from(slot.line));
        within(line.map(|line| &line.head), slot, |_| 2)
    }

    fn resources_of(&self, slot: Slot) -> Range<u32> {
        0..u32::from(is_actuator(PORTS, slot))
    }

    fn read(&self, slot: Slot, value: &mut [u64]) -> bool {
        tell(PORTS, self, slot, value)
    }

    fn check(&mut self, slot: Slot, value: &[u64]) -> Refusal {
        match self.judge(value) {
            Ok(_) if is_actuator(PORTS, slot) => {
                self.code = Code::OK;
                Refusal::NONE
            }
            Ok(_) => Refusal::ILLEGAL_VALUE,
            Err((code, value, limit)) => {
                self.blame(code, value, limit);
                Refusal::ILLEGAL_VALUE
            }
        }
    }

    fn jump(&self, _slot: Slot, value: &[u64]) -> Option<Jump> {
        let (code, value, limit) = self.judge(value).err()?;
        let quantity = match code {
            Code::VELOCITY => Quantity::Velocity,
            Code::ACCELERATION => Quantity::Acceleration,
            _ => return None,
        };
        Some(Jump {
            resource: 0,
            quantity,
            value,
            limit,
        })
    }

    fn error(&self, _slot: Slot) -> i64 {
        self.code.0
    }

    fn write(&mut self, slot: Slot, value: &[u64]) {
        if is_actuator(PORTS, slot) {
            self.staged = self.judge(value).ok();
        }
    }

    fn moving(&self, _resource: u32) -> bool {
        self.is_moving()
    }

    fn stop(&mut self, _resource: u32) {
        self.staged = None;
        self.braking = self.is_moving();
    }

    fn begin(&mut self, _resource: u32, ticks: u32) {
        self.pace = ticks.max(1);
        self.code = Code::OK;
    }

    fn step(&mut self, time: f64) {
        self.time = time;
        self.decide();
        self.drive();
    }

    fn code(&self) -> Code {
        self.code
    }

    fn reports(&mut self, each: &mut dyn FnMut(Report)) -> u64 {
        self.reports.drain(..).for_each(each);
        0
    }
}
