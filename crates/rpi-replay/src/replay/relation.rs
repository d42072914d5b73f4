//! Comparison of a computed value with the recorded one.

use rpi_image::Type;

use super::compare::{angle_deviation, deviation, near_lock, near_lock_angle};
use super::recorded::Recorded;

/// Result of comparing a computed value with the recorded one.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Relation {
    /// The values cannot be compared.
    Unknown,
    /// The deviation is within the tolerance.
    Agrees(f64),
    /// The values are the same angle in different notations, within the tolerance. The recorded value must be used from
    /// here on.
    Rewritten,
    /// The deviation exceeds the tolerance. It is `None` if one value is absent.
    Differs(Option<f64>),
}

/// How a value is compared.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Nature {
    /// As a plain value.
    Plain,
    /// As an angle.
    Angle,
    /// As one of three Euler angles. The argument is the recorded middle angle in radians.
    Euler(f64),
}

/// Tolerances of the comparison.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Tolerance {
    pub(super) usual: f64,
    pub(super) near_lock: f64,
}

/// Compares a computed value with the recorded one.
pub(super) fn relate(
    ty: Type,
    nature: Nature,
    computed: Option<&[u64]>,
    recorded: &Recorded,
    tolerance: Tolerance,
) -> Relation {
    match (computed, recorded) {
        (_, Recorded::Unknown) => Relation::Unknown,
        (None, Recorded::Absent) | (Some(_), Recorded::Opaque) => Relation::Agrees(0.0),
        (Some(a), Recorded::Value(b)) => values(ty, nature, (a, b), tolerance),
        (None, _) | (_, Recorded::Absent | Recorded::Foreign(_)) => Relation::Differs(None),
    }
}

/// Returns true if two values are equal within the tolerance.
pub(super) fn same(ty: Type, a: &[u64], b: &[u64], tolerance: Tolerance) -> bool {
    matches!(
        values(ty, Nature::Plain, (a, b), tolerance),
        Relation::Agrees(_)
    )
}

fn values(ty: Type, nature: Nature, (a, b): (&[u64], &[u64]), tolerance: Tolerance) -> Relation {
    let plain = deviation(ty, a, b);
    if plain <= tolerance.usual {
        return Relation::Agrees(plain);
    }
    let (distance, allowed) = match nature {
        Nature::Plain if near_lock(ty, b) && plain <= tolerance.near_lock => {
            return Relation::Agrees(plain);
        }
        Nature::Plain => return Relation::Differs(Some(plain)),
        Nature::Angle => (angle_deviation(a, b), tolerance.usual),
        Nature::Euler(middle) if near_lock_angle(middle) => {
            (angle_deviation(a, b), tolerance.near_lock)
        }
        Nature::Euler(_) => (angle_deviation(a, b), tolerance.usual),
    };
    match distance <= allowed {
        true => Relation::Rewritten,
        false => Relation::Differs(Some(distance)),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use rpi_image::Scalar;

    use super::*;

    const TOLERANCE: Tolerance = Tolerance {
        usual: 1e-9,
        near_lock: 1e-6,
    };

    fn reals(nature: Nature, a: f64, b: f64) -> Relation {
        let recorded = Recorded::Value(vec![b.to_bits()]);
        relate(
            Scalar::Real.into(),
            nature,
            Some(&[a.to_bits()]),
            &recorded,
            TOLERANCE,
        )
    }

    #[test]
    fn absence_agrees_with_absence_only() {
        let one = [1u64];
        let of = |computed, recorded| {
            relate(
                Scalar::Int.into(),
                Nature::Plain,
                computed,
                &recorded,
                TOLERANCE,
            )
        };
        assert_eq!(of(None, Recorded::Absent), Relation::Agrees(0.0));
        assert_eq!(of(Some(&one), Recorded::Absent), Relation::Differs(None));
        assert_eq!(of(None, Recorded::Value(vec![1])), Relation::Differs(None));
        assert_eq!(of(None, Recorded::Unknown), Relation::Unknown);
        assert_eq!(of(Some(&one), Recorded::Opaque), Relation::Agrees(0.0));
        assert_eq!(of(None, Recorded::Opaque), Relation::Differs(None));
    }

    #[test]
    fn full_turns_matter_except_for_angles() {
        assert_eq!(reals(Nature::Angle, -PI, PI), Relation::Rewritten);
        assert!(matches!(
            reals(Nature::Plain, -PI, PI),
            Relation::Differs(Some(_))
        ));
        assert!(matches!(
            reals(Nature::Angle, 0.1 - PI, PI),
            Relation::Differs(Some(_))
        ));
    }

    #[test]
    fn euler_angles_are_coarse_near_lock_only() {
        assert_eq!(
            reals(Nature::Euler(PI / 2.0), 0.3, 0.3 + 5e-7),
            Relation::Rewritten
        );
        assert!(matches!(
            reals(Nature::Euler(PI / 2.0), 0.3, 0.3 + 5e-6),
            Relation::Differs(Some(_))
        ));
        assert!(matches!(
            reals(Nature::Euler(1.0), 0.3, 0.3 + 5e-7),
            Relation::Differs(Some(_))
        ));
    }
}
