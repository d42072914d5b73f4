//! Numbers with units. `0.5` is in the SI unit of its key; `"30 deg"` and `"30[deg]"` have explicit units.

/// Physical dimension of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dimension {
    /// A number without a unit.
    Number,
    /// Angle, rad.
    Angle,
    /// Angular velocity, rad/s.
    AngularVelocity,
    /// Angular acceleration, rad/s².
    AngularAcceleration,
    /// Angular jerk, rad/s³.
    AngularJerk,
    /// Length, m.
    Length,
    /// Velocity, m/s.
    Velocity,
    /// Acceleration, m/s².
    Acceleration,
    /// Jerk, m/s³.
    Jerk,
    /// Time, s.
    Time,
    /// Force, N.
    Force,
    /// Torque, N m.
    Torque,
}

use Dimension::{
    Acceleration, Angle, AngularAcceleration, AngularJerk, AngularVelocity, Force, Jerk, Length,
    Time, Torque, Velocity,
};

const DEGREE: f64 = core::f64::consts::PI / 180.0;

/// All units with their factors to the SI unit. The SI unit of each dimension comes first.
const UNITS: &[(Dimension, &str, f64)] = &[
    (Angle, "rad", 1.0),
    (Angle, "deg", DEGREE),
    (AngularVelocity, "rad/s", 1.0),
    (AngularVelocity, "deg/s", DEGREE),
    (AngularAcceleration, "rad/s^2", 1.0),
    (AngularAcceleration, "deg/s^2", DEGREE),
    (AngularJerk, "rad/s^3", 1.0),
    (AngularJerk, "deg/s^3", DEGREE),
    (Length, "m", 1.0),
    (Length, "cm", 1e-2),
    (Length, "mm", 1e-3),
    (Length, "um", 1e-6),
    (Velocity, "m/s", 1.0),
    (Velocity, "mm/s", 1e-3),
    (Acceleration, "m/s^2", 1.0),
    (Acceleration, "mm/s^2", 1e-3),
    (Jerk, "m/s^3", 1.0),
    (Time, "s", 1.0),
    (Time, "ms", 1e-3),
    (Time, "us", 1e-6),
    (Time, "min", 60.0),
    (Force, "N", 1.0),
    (Force, "kN", 1e3),
    (Torque, "N m", 1.0),
    (Torque, "Nm", 1.0),
];

/// Parses a text such as `30 deg` into SI units. The error is a help text.
pub(super) fn parse(text: &str, dimension: Dimension) -> Result<f64, String> {
    let text = text.trim();
    let end = text.find(|c: char| !(c.is_ascii_digit() || "+-._eE".contains(c)));
    // No unit starts with `e` or `E`, so an `e` belongs to the number.
    let (number, unit) = text.split_at(end.unwrap_or(text.len()));
    let unit = unit
        .trim()
        .trim_start_matches('[')
        .trim_end_matches(']')
        .trim();
    let number: f64 = number.replace('_', "").parse().map_err(|_| {
        format!(
            "expected a number and a unit, like \"2.5 {}\"",
            si_unit(dimension)
        )
    })?;
    if unit.is_empty() {
        return Ok(number);
    }
    let known = UNITS
        .iter()
        .find(|(of, name, _)| *of == dimension && *name == unit);
    known
        .map(|(_, _, size)| number * size)
        .ok_or_else(|| units_of(dimension))
}

/// Returns the text of the SI unit in which a key of this dimension is read: `m`, `rad/s`.
pub(super) fn si_unit(dimension: Dimension) -> &'static str {
    let own = UNITS.iter().find(|(of, _, _)| *of == dimension);
    own.map_or("", |(_, name, _)| name)
}

fn units_of(dimension: Dimension) -> String {
    let own = UNITS
        .iter()
        .filter(|(of, _, _)| *of == dimension)
        .map(|(_, name, _)| *name);
    let names: Vec<&str> = own.collect();
    if names.is_empty() {
        return "this is a plain number without a unit".to_owned();
    }
    format!("expected one of the units {}", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_convert_to_si() {
        assert_eq!(parse("2", Angle), Ok(2.0));
        assert_eq!(parse("180 deg", Angle), Ok(core::f64::consts::PI));
        assert_eq!(parse("180[deg]", Angle), Ok(core::f64::consts::PI));
        assert_eq!(parse(" -1_000.5e-1 mm ", Length), Ok(-100.05 * 1e-3));
        assert_eq!(parse("20ms", Time), Ok(20.0 * 1e-3));
    }

    #[test]
    fn what_does_not_fit_is_told_what_would() {
        assert!(parse("3 kg", Angle).is_err_and(|help| help.contains("rad, deg")));
        assert!(parse("fast", Time).is_err_and(|help| help.contains("2.5 s")));
        assert!(parse("3 m", Dimension::Number).is_err_and(|help| help.contains("plain number")));
    }
}
