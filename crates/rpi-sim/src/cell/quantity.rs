//! Numbers with units. `0.5` is in the SI unit of its key; `"30 deg"` and `"30[deg]"` have explicit units.

use core::fmt;

/// Physical dimension of a number in a description of a cell or robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dimension {
    /// A number without a unit.
    Number,
    /// Angle, in rad.
    Angle,
    /// Angular velocity, in rad/s.
    AngularVelocity,
    /// Angular acceleration, in rad/s².
    AngularAcceleration,
    /// Angular jerk, in rad/s³.
    AngularJerk,
    /// Length, in m.
    Length,
    /// Velocity, in m/s.
    Velocity,
    /// Acceleration, in m/s².
    Acceleration,
    /// Jerk, in m/s³.
    Jerk,
    /// Time, in s.
    Time,
    /// Force, in N.
    Force,
    /// Torque, in N m.
    Torque,
    /// Mass, in kg.
    Mass,
    /// Moment of inertia, in kg m².
    Inertia,
}

use Dimension::{
    Acceleration, Angle, AngularAcceleration, AngularJerk, AngularVelocity, Force, Inertia, Jerk,
    Length, Mass, Time, Torque, Velocity,
};

const DEGREE: f64 = core::f64::consts::PI / 180.0;

/// Table of units: dimension, name, and factor to the SI unit. The SI unit of each dimension comes first.
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
    (Mass, "kg", 1.0),
    (Mass, "g", 1e-3),
    (Inertia, "kg m^2", 1.0),
];

/// Error: a text is not a number with a unit of the expected dimension. The text names the expected form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct QuantityError(String);

impl fmt::Display for QuantityError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl core::error::Error for QuantityError {}

/// Parses a text such as `30 deg` and returns the number in the SI unit of the dimension. A number without a unit is in
/// the SI unit.
pub(crate) fn parse(text: &str, dimension: Dimension) -> Result<f64, QuantityError> {
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
        QuantityError(format!(
            "expected a number and a unit, like \"2.5 {}\"",
            si_unit(dimension)
        ))
    })?;
    if unit.is_empty() {
        return Ok(number);
    }
    let known = UNITS
        .iter()
        .find(|(of, name, _)| *of == dimension && *name == unit);
    known
        .map(|(_, _, size)| number * size)
        .ok_or_else(|| QuantityError(units_of(dimension)))
}

/// Returns the name of the SI unit of a dimension, such as `rad/s`; empty for numbers without a unit.
pub(crate) fn si_unit(dimension: Dimension) -> &'static str {
    let own = UNITS.iter().find(|(of, _, _)| *of == dimension);
    own.map_or("", |(_, name, _)| name)
}

/// Returns the names of all units of a dimension, the SI unit first; empty for numbers without a unit.
pub(crate) fn unit_names(dimension: Dimension) -> Vec<&'static str> {
    let own = UNITS.iter().filter(|(of, _, _)| *of == dimension);
    own.map(|(_, name, _)| *name).collect()
}

/// Returns the SI unit of a dimension after a space, to follow a number in a message; empty without a unit.
pub(crate) fn unit_suffix(dimension: Dimension) -> String {
    match si_unit(dimension) {
        "" => String::new(),
        unit => format!(" {unit}"),
    }
}

/// Returns a sentence for messages about the numbers that the dimensions allow, such as "expected a number in rad, or a
/// string with one of the units rad, deg".
pub(crate) fn expectation(dimensions: &[Dimension]) -> String {
    let mut names = Vec::new();
    let mut si_units = Vec::new();
    for dimension in dimensions {
        let own = unit_names(*dimension);
        if let Some(si_unit) = own.first().filter(|unit| !si_units.contains(*unit)) {
            si_units.push(*si_unit);
            names.extend(own);
        }
    }
    match si_units.as_slice() {
        [] => "expected a plain number without a unit".to_owned(),
        units => {
            let (units, names) = (units.join(" or "), names.join(", "));
            format!("expected a number in {units}, or a string with one of the units {names}")
        }
    }
}

fn units_of(dimension: Dimension) -> String {
    match unit_names(dimension).as_slice() {
        [] => "this is a plain number without a unit".to_owned(),
        names => format!("expected one of the units {}", names.join(", ")),
    }
}

/// Returns the regular expression (ECMA 262) of the strings that [`parse`] accepts for one of the dimensions, as JSON
/// schemas use them.
pub(crate) fn pattern(dimensions: &[Dimension]) -> String {
    let names = dimensions.iter().flat_map(|of| unit_names(*of));
    let names: Vec<String> = names.map(|name| name.replace('^', "\\^")).collect();
    let unit = match names.is_empty() {
        true => String::new(),
        false => format!("({})?\\s*", names.join("|")),
    };
    let digits = "([0-9][0-9_]*\\.?[0-9_]*|\\._*[0-9][0-9_]*)";
    format!("^\\s*_*[-+]?_*{digits}([eE]_*[-+]?[0-9_]+)?\\s*\\[*\\s*{unit}\\]*\\s*$")
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
        assert!(parse("3 kg", Angle).is_err_and(|help| help.0.contains("rad, deg")));
        assert!(parse("fast", Time).is_err_and(|help| help.0.contains("2.5 s")));
        assert!(parse("3 m", Dimension::Number).is_err_and(|help| help.0.contains("plain number")));
    }
}
