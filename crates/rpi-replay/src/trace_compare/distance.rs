//! Distance between two values.
//!
//! Reals use the mixed absolute and relative difference `|a - b| / max(1, |a|, |b|)`; NaN equals NaN. Angles are
//! compared modulo a full turn. Rotations are compared by the angle between them in radians, independent of their
//! notation. Booleans and integers differ by at least 1, times by milliseconds.

use std::f64::consts::{PI, TAU};

use rpi_image::{Scalar, Type};
use rpi_prims::value_types::{FlowType, Rotation};

/// Returns the distance between two values of one type, given as memory words; 0 if they are equal. Reals have the
/// mixed absolute and relative difference, rotations the angle between them in radians.
pub(super) fn deviation(ty: Type, a: &[u64], b: &[u64]) -> f64 {
    let scalar = element(ty);
    let size = scalar.slots() as usize;
    let pairs = a.chunks_exact(size).zip(b.chunks_exact(size));
    pairs
        .map(|(a, b)| scalar_deviation(scalar, a, b))
        .fold(0.0, f64::max)
}

/// Returns the distance in radians between two reals that are angles; whole turns do not count.
pub(super) fn angle_deviation(a: &[u64], b: &[u64]) -> f64 {
    let [a, b] = [a, b].map(|cells| f64::load(cells, 0));
    if (a - b).is_finite() {
        ((a - b + PI).rem_euclid(TAU) - PI).abs()
    } else {
        real_deviation(a.to_bits(), b.to_bits())
    }
}

/// Returns true if a rotation in the value is so close to gimbal lock that its Euler angles have few significant
/// digits: the middle angle is within a thousandth of a radian of a quarter turn.
pub(super) fn is_near_gimbal_lock(ty: Type, cells: &[u64]) -> bool {
    let scalar = element(ty);
    let at = match scalar {
        Scalar::Rotation => 0,
        Scalar::Pose => Scalar::Vector.slots() as usize,
        _ => return false,
    };
    let mut values = cells.chunks_exact(scalar.slots() as usize);
    values.any(|value| {
        let q = Rotation::load(value, at);
        is_quarter_turn(2.0 * (q.w * q.j - q.k * q.i))
    })
}

/// Returns true if Euler angles with this middle angle (rad) are so close to gimbal lock that they have few significant
/// digits: within a thousandth of a radian of a quarter turn.
pub(super) fn is_near_gimbal_lock_angle(middle: f64) -> bool {
    ((middle.abs() - PI / 2.0).abs()) < GIMBAL_LOCK_MARGIN
}

/// Distance of the middle Euler angle from a quarter turn, in radians, up to which a rotation is near gimbal lock.
const GIMBAL_LOCK_MARGIN: f64 = 1e-3;

fn is_quarter_turn(sine: f64) -> bool {
    // The sine of an angle d short of a quarter turn is 1 - d^2 / 2.
    1.0 - sine.abs() < GIMBAL_LOCK_MARGIN * GIMBAL_LOCK_MARGIN / 2.0
}

fn element(ty: Type) -> Scalar {
    match ty {
        Type::Scalar(scalar) | Type::Array(scalar, _) => scalar,
        Type::Matrix(..) => Scalar::Real,
    }
}

fn scalar_deviation(scalar: Scalar, a: &[u64], b: &[u64]) -> f64 {
    match scalar {
        Scalar::Bool | Scalar::Int => integer_deviation(a[0], b[0], 1.0),
        Scalar::Time => integer_deviation(a[0], b[0], 1e-6),
        Scalar::Rotation => rotation_deviation(a, b),
        Scalar::Pose => reals_deviation(&a[..3], &b[..3]).max(rotation_deviation(&a[3..], &b[3..])),
        Scalar::Real | Scalar::Vector | Scalar::Twist | Scalar::Wrench => reals_deviation(a, b),
    }
}

fn integer_deviation(a: u64, b: u64, unit: f64) -> f64 {
    a.cast_signed().abs_diff(b.cast_signed()) as f64 * unit
}

fn reals_deviation(a: &[u64], b: &[u64]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs
        .map(|(&a, &b)| real_deviation(a, b))
        .fold(0.0, f64::max)
}

fn real_deviation(a: u64, b: u64) -> f64 {
    let [a, b] = [a, b].map(f64::from_bits);
    if a == b || (a.is_nan() && b.is_nan()) {
        0.0
    } else if (a - b).is_finite() {
        (a - b).abs() / a.abs().max(b.abs()).max(1.0)
    } else {
        f64::INFINITY
    }
}

fn rotation_deviation(a: &[u64], b: &[u64]) -> f64 {
    let [a, b] = [a, b].map(|cells| Rotation::load(cells, 0));
    let is_nan = |q: &Rotation| q.coords.iter().any(|c| c.is_nan());
    match (is_nan(&a), is_nan(&b)) {
        (false, false) => a.angle_to(&b),
        (true, true) => 0.0,
        _ => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(scalar: Scalar, a: &str, b: &str) -> f64 {
        let [a, b] = [a, b].map(|text| rpi_literal::parse_scalar(text, scalar).unwrap().unwrap());
        deviation(scalar.into(), a.slots(), b.slots())
    }

    #[test]
    fn reals_are_near_by_the_larger_of_one_and_themselves() {
        assert_eq!(of(Scalar::Real, "0.0", "1.0E-9"), 1e-9);
        assert!((of(Scalar::Real, "1.0E9", "1000000001") - 1e-9).abs() < 1e-15);
        assert_eq!(of(Scalar::Real, "nan", "nan"), 0.0);
        assert_eq!(of(Scalar::Real, "+inf", "+inf"), 0.0);
        assert_eq!(of(Scalar::Real, "nan", "0"), f64::INFINITY);
        assert_eq!(of(Scalar::Real, "+inf", "-inf"), f64::INFINITY);
    }

    #[test]
    fn other_scalars_differ_by_steps() {
        assert_eq!(of(Scalar::Bool, "true", "false"), 1.0);
        assert_eq!(of(Scalar::Int, "3", "-4"), 7.0);
        assert_eq!(of(Scalar::Time, "1000", "1001"), 1.0);
    }

    #[test]
    fn rotations_are_compared_by_the_angle_between_them() {
        let turned = "{a:3.141592653589793,b:3.0415926535897932,c:3.141592653589793}";
        assert!(of(Scalar::Rotation, "{a:0,b:0.1,c:0}", turned) < 1e-15);
        assert!((of(Scalar::Rotation, "{a:0,b:0,c:0}", "{a:0,b:0,c:0.25}") - 0.25).abs() < 1e-15);
        let nan = "{a:nan,b:nan,c:nan}";
        assert_eq!(of(Scalar::Rotation, nan, nan), 0.0);
        assert_eq!(of(Scalar::Rotation, nan, "{a:0,b:0,c:0}"), f64::INFINITY);
    }

    #[test]
    fn structured_values_are_as_far_apart_as_their_worst_part() {
        let pose = |x, c| format!("{{pos:{{x:{x},y:0,z:0}},rot:{{a:0,b:0,c:{c}}}}}");
        assert_eq!(of(Scalar::Pose, &pose(0.5, 0), &pose(0.25, 0)), 0.25);
        assert!((of(Scalar::Pose, &pose(0.5, 0), &pose(0.5, 1)) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn angles_are_compared_modulo_a_full_turn() {
        let of = |a: f64, b: f64| angle_deviation(&[a.to_bits()], &[b.to_bits()]);
        assert!(of(-PI, PI) < 1e-15);
        assert!((of(0.1 - PI, PI) - 0.1).abs() < 1e-15);
        assert_eq!(of(f64::NAN, f64::NAN), 0.0);
        assert_eq!(of(f64::NAN, 0.0), f64::INFINITY);
    }

    #[test]
    fn lock_is_where_the_middle_angle_is_a_quarter_turn() {
        let lock = |b: f64| {
            let text = format!("{{a:0.3,b:{b},c:-1}}");
            let value = rpi_literal::parse_scalar(&text, Scalar::Rotation)
                .unwrap()
                .unwrap();
            is_near_gimbal_lock(Scalar::Rotation.into(), value.slots())
        };
        assert!(lock(PI / 2.0) && lock(-PI / 2.0 + 5e-4));
        assert!(!lock(1.56) && !lock(0.0));
        assert!(is_near_gimbal_lock_angle(-PI / 2.0 + 5e-4) && !is_near_gimbal_lock_angle(1.56));
    }
}
