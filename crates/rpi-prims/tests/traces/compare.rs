//! Equality of computed and recorded values.

use rpi_image::{Scalar, Type};

/// Relative and absolute tolerance.
const TOLERANCE: f64 = 1e-9;
/// Tolerance of angles near gimbal lock, where two of them rotate about one axis.
const GIMBAL_TOLERANCE: f64 = 1e-6;

/// Returns whether two values are equal within the tolerance of their type.
pub(crate) fn equal(ty: Type, ours: &[u64], theirs: &[u64]) -> bool {
    let scalar = match ty {
        Type::Scalar(s) | Type::Array(s, _) => s,
        Type::Matrix(..) => Scalar::Real,
    };
    let width = scalar.slots() as usize;
    let pairs = ours.chunks(width).zip(theirs.chunks(width));
    ours.len() == theirs.len() && pairs.into_iter().all(|(a, b)| one(scalar, a, b))
}

fn one(scalar: Scalar, a: &[u64], b: &[u64]) -> bool {
    match scalar {
        Scalar::Bool | Scalar::Int | Scalar::Time => a == b,
        Scalar::Real | Scalar::Vector | Scalar::Twist | Scalar::Wrench => reals(a, b),
        Scalar::Rotation => rotation(a, b),
        Scalar::Pose => reals(&a[..3], &b[..3]) && rotation(&a[3..], &b[3..]),
    }
}

fn reals(a: &[u64], b: &[u64]) -> bool {
    a.iter()
        .zip(b)
        .all(|(a, b)| near(f64::from_bits(*a), f64::from_bits(*b)))
}

fn near(a: f64, b: f64) -> bool {
    a == b
        || (a.is_nan() && b.is_nan())
        || (a - b).abs() <= TOLERANCE * (1.0 + a.abs().max(b.abs()))
}

/// Compares rotations. A quaternion and its negative are the same rotation.
fn rotation(a: &[u64], b: &[u64]) -> bool {
    let dot: f64 = a
        .iter()
        .zip(b)
        .map(|(a, b)| f64::from_bits(*a) * f64::from_bits(*b))
        .sum();
    let same = |sign: f64| {
        let mut pairs = a.iter().zip(b);
        pairs.all(|(a, b)| (f64::from_bits(*a) * sign - f64::from_bits(*b)).abs() <= TOLERANCE)
    };
    same(dot.signum()) || dot.is_nan()
}

/// Returns whether three Euler angles are equal modulo full turns.
pub(crate) fn euler(a: [f64; 3], b: [f64; 3]) -> bool {
    let locked = (a[1].abs() - std::f64::consts::FRAC_PI_2).abs() < 1e-4;
    let tolerance = if locked { GIMBAL_TOLERANCE } else { TOLERANCE };
    a.iter().zip(b).all(|(a, b)| {
        let turns = (a - b) / std::f64::consts::TAU;
        ((turns - turns.round()) * std::f64::consts::TAU).abs() <= tolerance
    })
}
