//! Comparison of a computed value with the recorded one.

use rpi_image::Type;

use super::distance::{angle_deviation, deviation, is_near_gimbal_lock, is_near_gimbal_lock_angle};
use super::trace_view::RecordedValue;

/// Result of comparing a computed value with the recorded one.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Relation {
    /// The values cannot be compared, because the trace has no value of the port in this cycle.
    NotComparable,
    /// The deviation of the computed value, in the field, is within the tolerance.
    Agrees(f64),
    /// The values are the same angle in different notations, within the tolerance. From here on, the recorded value is
    /// used in place of the computed one.
    EquivalentAngle,
    /// The deviation exceeds the tolerance. It is `None` if one value is absent.
    Differs(Option<f64>),
}

/// Kind of comparison of a computed with a recorded value.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum ComparisonKind {
    /// The values are compared as they are.
    Plain,
    /// The values are compared as angles: values that differ by whole turns are equal.
    Angle,
    /// The value is one of three Euler angles. The field is the recorded middle angle in radians, which shows whether
    /// they are near gimbal lock.
    Euler(f64),
}

/// Largest deviations, absolute up to 1 and relative above, with which a computed value counts as equal to the recorded
/// one: in general, and near gimbal lock.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Tolerance {
    pub(super) default: f64,
    pub(super) near_gimbal_lock: f64,
}

/// Returns whether a computed value of type `ty` agrees with the recorded one within the tolerance, differs, or cannot
/// be compared. `computed` holds memory words; `None` is an absent value.
pub(super) fn compare(
    ty: Type,
    nature: ComparisonKind,
    computed: Option<&[u64]>,
    recorded: &RecordedValue,
    tolerance: Tolerance,
) -> Relation {
    match (computed, recorded) {
        (_, RecordedValue::Unknown) => Relation::NotComparable,
        (None, RecordedValue::Absent) | (Some(_), RecordedValue::Unprintable) => {
            Relation::Agrees(0.0)
        }
        (Some(a), RecordedValue::Value(b)) => compare_values(ty, nature, (a, b), tolerance),
        (None, _) | (_, RecordedValue::Absent | RecordedValue::WrongType(_)) => {
            Relation::Differs(None)
        }
    }
}

/// Returns true if two values of type `ty`, given as memory words, are equal within the tolerance.
pub(super) fn equal_within(ty: Type, a: &[u64], b: &[u64], tolerance: Tolerance) -> bool {
    matches!(
        compare_values(ty, ComparisonKind::Plain, (a, b), tolerance),
        Relation::Agrees(_)
    )
}

fn compare_values(
    ty: Type,
    nature: ComparisonKind,
    (a, b): (&[u64], &[u64]),
    tolerance: Tolerance,
) -> Relation {
    let plain = deviation(ty, a, b);
    if plain <= tolerance.default {
        return Relation::Agrees(plain);
    }
    let (distance, allowed) = match nature {
        ComparisonKind::Plain
            if is_near_gimbal_lock(ty, b) && plain <= tolerance.near_gimbal_lock =>
        {
            return Relation::Agrees(plain);
        }
        ComparisonKind::Plain => return Relation::Differs(Some(plain)),
        ComparisonKind::Angle => (angle_deviation(a, b), tolerance.default),
        ComparisonKind::Euler(middle) if is_near_gimbal_lock_angle(middle) => {
            (angle_deviation(a, b), tolerance.near_gimbal_lock)
        }
        ComparisonKind::Euler(_) => (angle_deviation(a, b), tolerance.default),
    };
    match distance <= allowed {
        true => Relation::EquivalentAngle,
        false => Relation::Differs(Some(distance)),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use rpi_image::Scalar;

    use super::*;

    const TOLERANCE: Tolerance = Tolerance {
        default: 1e-9,
        near_gimbal_lock: 1e-6,
    };

    fn reals(nature: ComparisonKind, a: f64, b: f64) -> Relation {
        let recorded = RecordedValue::Value(vec![b.to_bits()]);
        compare(
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
            compare(
                Scalar::Int.into(),
                ComparisonKind::Plain,
                computed,
                &recorded,
                TOLERANCE,
            )
        };
        assert_eq!(of(None, RecordedValue::Absent), Relation::Agrees(0.0));
        assert_eq!(
            of(Some(&one), RecordedValue::Absent),
            Relation::Differs(None)
        );
        assert_eq!(
            of(None, RecordedValue::Value(vec![1])),
            Relation::Differs(None)
        );
        assert_eq!(of(None, RecordedValue::Unknown), Relation::NotComparable);
        assert_eq!(
            of(Some(&one), RecordedValue::Unprintable),
            Relation::Agrees(0.0)
        );
        assert_eq!(
            of(None, RecordedValue::Unprintable),
            Relation::Differs(None)
        );
    }

    #[test]
    fn full_turns_matter_except_for_angles() {
        assert_eq!(
            reals(ComparisonKind::Angle, -PI, PI),
            Relation::EquivalentAngle
        );
        assert!(matches!(
            reals(ComparisonKind::Plain, -PI, PI),
            Relation::Differs(Some(_))
        ));
        assert!(matches!(
            reals(ComparisonKind::Angle, 0.1 - PI, PI),
            Relation::Differs(Some(_))
        ));
    }

    #[test]
    fn euler_angles_are_coarse_near_lock_only() {
        assert_eq!(
            reals(ComparisonKind::Euler(PI / 2.0), 0.3, 0.3 + 5e-7),
            Relation::EquivalentAngle
        );
        assert!(matches!(
            reals(ComparisonKind::Euler(PI / 2.0), 0.3, 0.3 + 5e-6),
            Relation::Differs(Some(_))
        ));
        assert!(matches!(
            reals(ComparisonKind::Euler(1.0), 0.3, 0.3 + 5e-7),
            Relation::Differs(Some(_))
        ));
    }
}
