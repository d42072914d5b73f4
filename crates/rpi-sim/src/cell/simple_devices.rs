//! Devices with `kind = "base"`, and small devices, whose keys are in tables.

use super::periods::read_periods;
use super::quantity::Dimension::{
    Acceleration, Angle, AngularAcceleration, AngularVelocity, Force, Length, Time, Torque,
    Velocity,
};
use super::reader::TableReader;
use crate::kinds::{Key, KeyDefault, KeyType, Setting, Settings, SmallKind, SmallSpec};
use nalgebra::Vector6;

/// Description of a mobile base with two driven wheels.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseSpec {
    /// Initial position in the cell: x, y (m), heading (rad).
    pub position: [f64; 3],
    /// Distance between the two wheels, in m.
    pub track: f64,
    /// Radius of the wheels, in m.
    pub wheel_radius: f64,
    /// Maximum forward velocity (m/s) and angular velocity (rad/s).
    pub velocity: [f64; 2],
    /// Maximum forward acceleration (m/s²) and angular acceleration (rad/s²).
    pub acceleration: [f64; 2],
    /// Number of periods without set-points after which a moving base brakes, at least 1.
    pub watchdog: u32,
}

pub(super) fn read_base(reader: &mut TableReader<'_>) -> Option<BaseSpec> {
    let position = reader
        .reals("position", Length, 2)
        .unwrap_or_else(|| vec![0.0; 2]);
    let heading = reader.real("heading", Angle).unwrap_or(0.0);
    Some(BaseSpec {
        position: [position[0], position[1], heading],
        track: reader.positive("track", Length).unwrap_or(0.4),
        wheel_radius: reader.positive("wheel_radius", Length).unwrap_or(0.1),
        velocity: [
            reader.positive("velocity", Velocity).unwrap_or(1.0),
            reader
                .positive("turning_velocity", AngularVelocity)
                .unwrap_or(1.5),
        ],
        acceleration: [
            reader.positive("acceleration", Acceleration).unwrap_or(1.0),
            reader
                .positive("turning_acceleration", AngularAcceleration)
                .unwrap_or(3.0),
        ],
        watchdog: read_periods(reader, "watchdog").unwrap_or(1),
    })
}

/// Reads the keys of a small device (a sensor, or a device with one actuator) of the given kind.
pub(super) fn read_small(kind: &'static SmallKind, reader: &mut TableReader<'_>) -> SmallSpec {
    let mut settings = Settings::default();
    for key in kind.keys() {
        let default = match key.default {
            KeyDefault::Number(value) => Some(Setting::Number(value)),
            KeyDefault::SameAs(other) => settings.optional(other).map(Setting::Number),
            KeyDefault::Absent(_) => None,
        };
        let value = read_setting(key, reader);
        let number = match key.default {
            KeyDefault::Number(value) => Some(value),
            _ => None,
        };
        reader.record_description(key.name, || key.schema_description(), number);
        if let Some(value) = value.or(default) {
            settings.add(key.name, value);
        }
    }
    if let Err((key, message)) = (kind.check_settings)(&settings) {
        reader.error_at(key, message, None);
    }
    SmallSpec { kind, settings }
}

fn read_setting(key: &Key, reader: &mut TableReader<'_>) -> Option<Setting> {
    let name = key.name;
    match key.ty {
        KeyType::NotNegative(dimension) => reader.magnitude(name, dimension).map(Setting::Number),
        KeyType::Positive(dimension) => reader.positive(name, dimension).map(Setting::Number),
        KeyType::Periods => {
            let periods = read_periods(reader, name);
            periods.map(|periods| Setting::Number(f64::from(periods)))
        }
        KeyType::Wrenches => Some(Setting::Wrenches(read_script(reader, name, read_wrench))),
        KeyType::Switches => Some(Setting::Switches(read_script(reader, name, read_switch))),
    }
}

/// Reads a list of tables, each with a time in s, and returns the entries in the order of their times.
fn read_script<T>(
    reader: &mut TableReader<'_>,
    key: &'static str,
    read: fn(TableReader<'_>) -> (f64, T),
) -> Vec<(f64, T)> {
    let changes = reader.tables(key).into_iter();
    let mut script: Vec<(f64, T)> = changes.map(read).collect();
    script.sort_by(|one, other| one.0.total_cmp(&other.0));
    script
}

/// Reads a table `{ at = time, value = true or false }` of a script.
fn read_switch(mut reader: TableReader<'_>) -> (f64, bool) {
    let at = reader.magnitude("at", Time).unwrap_or(0.0);
    let value = reader.boolean("value");
    reader.require("value", "expected true or false");
    reader.finish();
    (at, value.unwrap_or_default())
}

/// Reads a table `{ at = time, force = [x, y, z], torque = [x, y, z] }` of a script, in s, N and N m. Missing keys are
/// 0.
fn read_wrench(mut reader: TableReader<'_>) -> (f64, Vector6<f64>) {
    let at = reader.magnitude("at", Time).unwrap_or(0.0);
    let force = reader
        .reals("force", Force, 3)
        .unwrap_or_else(|| vec![0.0; 3]);
    let torque = reader
        .reals("torque", Torque, 3)
        .unwrap_or_else(|| vec![0.0; 3]);
    reader.finish();
    (at, Vector6::from_iterator(force.into_iter().chain(torque)))
}
