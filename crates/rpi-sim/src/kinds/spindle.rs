//! A spindle with a speed set-point.

use super::ramp::Ramp;
use super::{BuildContext, Key, Settings, SmallDevice, check_range};
use crate::arm::limits::Violation;
use crate::cell::quantity::Dimension::{AngularAcceleration, AngularVelocity};
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
}

impl SmallDevice for Spindle {
    const KIND: &'static str = "spindle";
    const TITLE: &'static str = "spindle";
    const DEVICE_TYPE: &'static str = "Spindle";
    const DESCRIPTION: &'static str = "A spindle follows speed set-points with its own acceleration. It brakes without set-points.";
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
        PortRow::<Self>::actuator("speed", Real).means("set-point of the velocity, rad/s"),
    ];

    fn new(settings: &Settings, context: &BuildContext) -> Self {
        Self {
            drive: Ramp::new(settings.number("acceleration"), context.tick),
            fastest: settings.number("velocity"),
            tolerance: settings.number("tolerance"),
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
    }

    fn is_moving(&self) -> bool {
        self.drive.is_moving()
    }

    fn stop(&mut self) {
        self.drive.target = 0.0;
    }
}

impl Spindle {
    fn is_at_speed(&self) -> bool {
        let Ramp {
            velocity, target, ..
        } = self.drive;
        velocity != 0.0 && (velocity - target).abs() <= self.tolerance
    }
}
