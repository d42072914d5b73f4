//! A conveyor belt with a velocity set-point and an encoder.

use super::ramp::Ramp;
use super::{BuildContext, Key, Settings, SmallDevice, check_range};
use crate::arm::limits::Violation;
use crate::cell::quantity::Dimension::{Acceleration, Velocity};
use crate::device::PortRow;
use crate::error_code::ErrorCode;
use rpi_image::Scalar::{Bool, Real};

/// Conveyor belt of a simulated cell.
#[derive(Clone, Debug)]
pub(super) struct Conveyor {
    drive: Ramp,
    /// Maximum velocity in both directions, in m/s.
    fastest: f64,
}

impl SmallDevice for Conveyor {
    const KIND: &'static str = "conveyor";
    const TITLE: &'static str = "conveyor";
    const DEVICE_TYPE: &'static str = "Conveyor";
    const DESCRIPTION: &'static str = "A belt follows velocity set-points with its own acceleration. It brakes without set-points.";
    const IS_WATCHED: bool = true;
    const KEYS: &'static [Key] = &[
        Key::positive(
            "velocity",
            Velocity,
            1.0,
            "greatest velocity in both directions",
        ),
        Key::positive(
            "acceleration",
            Acceleration,
            1.0,
            "acceleration of the belt",
        ),
    ];
    const PORTS: &'static [PortRow<Self>] = &[
        PortRow::<Self>::sensor("position", Real, |belt, _, out| {
            out.put_real(belt.drive.position)
        })
        .means("way of the belt since the start of the cell, m"),
        PortRow::<Self>::sensor("velocity", Real, |belt, _, out| {
            out.put_real(belt.drive.velocity)
        })
        .means("m/s, negative backwards"),
        PortRow::<Self>::sensor("moving", Bool, |belt, _, out| {
            out.put_bits(u64::from(belt.drive.velocity != 0.0))
        })
        .means("true while the belt moves"),
        PortRow::<Self>::actuator("speed", Real).means("set-point of the velocity, m/s"),
    ];

    fn new(settings: &Settings, context: &BuildContext) -> Self {
        Self {
            drive: Ramp::new(settings.number("acceleration"), context.tick),
            fastest: settings.number("velocity"),
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
