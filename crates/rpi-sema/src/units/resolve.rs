//! Resolves a unit in the source to a dimension and a factor.

use crate::units::table::{ALIASES, Factor, PREFIXES, UNITS, UnitDef};
use crate::units::{Dimension, Ratio};
use rpi_diag::{Span, suggest};
use rpi_syntax::ast::{Unit, UnitFactor};

/// Meaning of a unit in the source: its dimension, and its factor to coherent SI units.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ResolvedUnit {
    /// Physical dimension that the unit measures.
    pub dim: Dimension,
    /// Factor by which a number in this unit is multiplied to get the value in the coherent SI unit.
    pub factor: Factor,
}

/// Reason why a unit in the source has no meaning.
#[derive(Clone, PartialEq, Debug)]
pub enum UnitError {
    /// A name in the unit is not the name of any unit.
    Unknown {
        /// Unknown name in the unit.
        name: String,
        /// Location of the unknown name.
        span: Span,
        /// Similar unit that may have been meant; `None` if there is none.
        near: Option<String>,
    },
    /// An exponent in the unit is out of the supported range.
    Exponent {
        /// Location of the whole unit.
        span: Span,
    },
}

/// Returns the dimension and factor of a unit in the source. `parameter` returns the dimension of a type parameter,
/// such as `T` in `real[T/s]`, and `None` for other names. Type parameters take precedence over units of the same name.
///
/// # Errors
///
/// Returns an error for an undefined unit, or for an exponent that is out of range.
pub fn resolve(
    unit: &Unit,
    parameter: &dyn Fn(&str) -> Option<Dimension>,
) -> Result<ResolvedUnit, UnitError> {
    let plain = ResolvedUnit {
        dim: Dimension::ONE,
        factor: Factor::ONE,
    };
    unit.factors.iter().try_fold(plain, |whole, part| {
        let part_measure = factor(part, parameter)?;
        let dim = whole.dim.times(part_measure.dim);
        Ok(ResolvedUnit {
            dim: dim.ok_or(UnitError::Exponent { span: unit.span })?,
            factor: whole.factor.times(part_measure.factor),
        })
    })
}

fn factor(
    part: &UnitFactor,
    parameter: &dyn Fn(&str) -> Option<Dimension>,
) -> Result<ResolvedUnit, UnitError> {
    let (dim, factor) = match parameter(&part.unit.name) {
        Some(dim) => (dim, Factor::ONE),
        None => {
            let (prefix, row) = find_unit(&part.unit.name).ok_or_else(|| unknown(part))?;
            (row.dim(), prefix.times(row.factor))
        }
    };
    let power = Ratio::from_int(part.power).and_then(|power| dim.power(power));
    Ok(ResolvedUnit {
        dim: power.ok_or(UnitError::Exponent {
            span: part.unit.span,
        })?,
        factor: factor.power(part.power),
    })
}

/// Returns whether a name is a unit, with or without a prefix, such as `mm` or `N`.
#[must_use]
pub fn is_unit(name: &str) -> bool {
    find_unit(name).is_some()
}

/// Returns the factor of the prefix and the unit for a name such as `mm`; `None` if there is none. A unit without a
/// prefix takes precedence: `min` is a minute, `cd` a candela.
fn find_unit(name: &str) -> Option<(Factor, &'static UnitDef)> {
    if let Some(row) = UNITS.iter().find(|row| row.name == name) {
        return Some((Factor::ONE, row));
    }
    PREFIXES.iter().find_map(|(prefix, factor)| {
        let rest = name.strip_prefix(prefix)?;
        let row = UNITS
            .iter()
            .find(|row| row.takes_prefix && row.name == rest)?;
        Some((*factor, row))
    })
}

fn unknown(part: &UnitFactor) -> UnitError {
    UnitError::Unknown {
        name: part.unit.name.to_string(),
        span: part.unit.span,
        near: suggest_unit(&part.unit.name),
    }
}

/// Returns the unit that was probably meant by an unknown name: a unit with another name or case, a product without
/// `*`, or a similar spelling. `None` if there is none.
fn suggest_unit(name: &str) -> Option<String> {
    let common = ["mm", "cm", "km", "kg", "ms", "us", "kN", "mA", "kW", "mV"];
    let all = || UNITS.iter().map(|row| row.name).chain(common);
    let lower = name.to_lowercase();
    let other = ALIASES.iter().find(|row| row.0.to_lowercase() == lower);
    let other = other.map(|row| row.1.to_owned());
    let cased = || {
        all()
            .find(|unit| unit.to_lowercase() == lower)
            .map(str::to_owned)
    };
    let joined = || {
        let parts = (1..name.len()).filter_map(|at| name.split_at_checked(at));
        let mut known = parts.filter(|(a, b)| find_unit(a).is_some() && find_unit(b).is_some());
        known.next().map(|(a, b)| format!("{a}*{b}"))
    };
    other
        .or_else(cased)
        .or_else(joined)
        .or_else(|| suggest(name, all()))
        .or_else(|| {
            let near = suggest(name, ALIASES.iter().map(|row| row.0))?;
            let row = ALIASES.iter().find(|row| row.0 == near);
            row.map(|row| row.1.to_owned())
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(factors: &[(&str, i32)]) -> Result<ResolvedUnit, UnitError> {
        resolve(&Unit::synthetic(factors.iter().copied()), &|_| None)
    }

    fn apply(value: f64, factors: &[(&str, i32)]) -> (f64, String) {
        let measure = of(factors).unwrap();
        (measure.factor.apply(value), measure.dim.to_string())
    }

    #[test]
    fn prefixes_and_powers() {
        let mm_per_s = [("mm", 1), ("s", -1)];
        assert_eq!(apply(250.0, &mm_per_s), (0.25, "m/s".into()));
        assert_eq!(apply(9.0, &[("mm", 1)]), (0.009, "m".into()));
        assert_eq!(apply(1.0, &[("cm", 2)]), (1e-4, "m^2".into()));
        assert_eq!(apply(2.0, &[("kN", 1)]), (2000.0, "N".into()));
        assert_eq!(apply(90.0, &[("deg", 1)]).0, std::f64::consts::FRAC_PI_2);
        assert_eq!(apply(60.0, &[("%", 1)]), (0.6, "1".into()));
    }

    #[test]
    fn units_win_over_prefixed_ones() {
        assert_eq!(apply(1.0, &[("min", 1)]), (60.0, "s".into()));
        assert_eq!(apply(1.0, &[("cd", 1)]), (1.0, "cd".into()));
        assert_eq!(apply(1.0, &[("Pa", 1)]).1, "Pa");
    }

    #[test]
    fn faults_say_what_is_wrong() {
        let Err(UnitError::Unknown { near, .. }) = of(&[("rmp", 1)]) else {
            panic!("`rmp` must be undefined");
        };
        assert_eq!(near.as_deref(), Some("rpm"));
        for (written, meant) in [("sec", "s"), ("hz", "Hz"), ("As", "A*s"), ("mms", "mm/s")] {
            assert_eq!(
                super::suggest_unit(written).as_deref(),
                Some(meant),
                "{written}"
            );
        }
        assert!(matches!(of(&[("m", 500)]), Err(UnitError::Exponent { .. })));
    }
}
