//! A spindle with a speed set-point. It may drive a screw, which seats at an angle and resists from there on.

use super::ramp::Ramp;
use super::{BuildContext, Key, KeyDefault, KeyType, Settings, SmallDevice, check_range};
use crate::arm::limits::Violation;
use crate::cell::quantity::Dimension::{Angle, AngularAcceleration, AngularVelocity, Torque};
use crate::device::PortRow;
use crate::error_code::ErrorCode;
use rpi_image::Scalar::{Bool, Real};

/// Spindle of a simulated cell.
#[derive(Clone, Debug)]
pub(super) struct Spindle {
    drive: Ramp,
    /// Maximum velocity in both directions, in rad/s.
    fastest: f64,
    /// Maximum difference between velocity and set-point at which the spindle counts as at its speed, in rad/s.
    tolerance: f64,
    /// Maximum torque of the drive, in N m, at which it stalls.
    strongest: f64,
    /// Angle at which the head of the screw seats, in rad; `None` without a screw.
    seat: Option<f64>,
}

/// Stiffness of a seated screw, in N m/rad: a metal joint of a small screw reaches its torque within an eighth of a turn.
const STIFFNESS: f64 = 5.0;

impl SmallDevice for Spindle {
    const KIND: &'static str = "spindle";
    const TITLE: &'static str = "spindle";
    const DEVICE_TYPE: &'static str = "Spindle";
    const DESCRIPTION: &'static str = "A spindle follows speed set-points with its own acceleration. It brakes without set-points. A screw turns freely until its head seats, then it resists with 5 N m/rad; the drive stalls at its greatest torque.";
    const IS_WATCHED: bool = true;
    const KEYS: &'static [Key] = &[
        Key::positive(
            "velocity",
            AngularVelocity,
            1000.0,
            "greatest velocity in both directions",
        ),
        Key::positive(
            "acceleration",
            AngularAcceleration,
            500.0,
            "acceleration of the spindle",
        ),
        Key::positive(
            "tolerance",
            AngularVelocity,
            1.0,
            "difference to the set-point within which `at_speed` holds",
        ),
        Key::positive(
            "torque",
            Torque,
            5.0,
            "greatest torque, at which the drive stalls",
        ),
        Key::new(
            "seat",
            KeyType::NotNegative(Angle),
            KeyDefault::Absent("no screw"),
            "angle since the start at which the head of a screw seats",
        ),
    ];
    const PORTS: &'static [PortRow<Self>] = &[
        PortRow::<Self>::sensor("velocity", Real, |spindle, _, out| {
            out.put_real(spindle.drive.velocity)
        })
        .means("rad/s, negative against the direction of rotation"),
        PortRow::<Self>::sensor("at_speed", Bool, |spindle, _, out| {
            out.put_bits(u64::from(spindle.is_at_speed()))
        })
        .means("true if the velocity is the set-point within `tolerance`, and not 0"),
        PortRow::<Self>::sensor("angle", Real, |spindle, _, out| {
            out.put_real(spindle.drive.position)
        })
        .means("angle since the start of the cell, rad, over all turns"),
        PortRow::<Self>::sensor("torque", Real, |spindle, _, out| {
            out.put_real(spindle.torque())
        })
        .means("N m, of the screw on the spindle; 0 without a seated screw"),
        PortRow::<Self>::actuator("speed", Real).means("set-point of the velocity, rad/s"),
    ];

    fn new(settings: &Settings, context: &BuildContext) -> Self {
        Self {
            drive: Ramp::new(settings.number("acceleration"), context.tick),
            fastest: settings.number("velocity"),
            tolerance: settings.number("tolerance"),
            strongest: settings.number("torque"),
            seat: settings.optional("seat"),
        }
    }

    fn check(&self, set_point: f64) -> Result<(), Violation> {
        check_range(
            set_point,
            [-self.fastest, self.fastest],
            ErrorCode::VELOCITY,
        )
    }

    fn set(&mut self, set_point: f64) {
        self.drive.target = set_point;
    }

    fn step(&mut self, _time: f64) {
        self.drive.step();
        let stalled = self.seat.map(|seat| seat + self.strongest / STIFFNESS);
        if let Some(stalled) = stalled.filter(|stalled| self.drive.position >= *stalled) {
            self.drive.position = stalled;
            self.drive.velocity = self.drive.velocity.min(0.0);
        }
    }

    fn is_moving(&self) -> bool {
        self.drive.is_moving()
    }

    fn stop(&mut self) {
        self.drive.target = 0.0;
    }
}

impl Spindle {
    /// Returns the torque that the seated screw exerts against the rotation, in N m.
    fn torque(&self) -> f64 {
        let beyond = self.seat.map_or(0.0, |seat| self.drive.position - seat);
        (STIFFNESS * beyond).clamp(0.0, self.strongest)
    }

    fn is_at_speed(&self) -> bool {
        let Ramp {
            velocity, target, ..
        } = self.drive;
        velocity != 0.0 && (velocity - target).abs() <= self.tolerance
    }
}
