//! Models of faults of the reference system. A recorded value that equals the result of a model is explained by the
//! fault.

use super::{DifferenceCase, FaultyValue, MAX_SLOTS};
use crate::catalogue::frame_otg::{self, Limits};
use crate::catalogue::otg;
use crate::geometry;
use crate::value_types::{Pose, Rotation, Time, Twist, Vector};
use core::ops::Range;
use rpi_image::{PortType, Scalar, Value};

/// Models the sine computed instead of the cosine, from the recorded input: the reference swaps both functions.
pub(super) fn sine_as_cosine(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    Some(FaultyValue::value(libm::cos(case.input(0)?)))
}

/// Models the cosine computed instead of the sine: the reference swaps both functions.
pub(super) fn cosine_as_sine(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    Some(FaultyValue::value(libm::sin(case.input(0)?)))
}

/// Returns the axis of a rotation as the reference system computes it: the z component is taken from the wrong elements
/// of the matrix.
fn axis(rotation: Rotation) -> Vector {
    let m = geometry::matrix(rotation);
    let axis = Vector::new(m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][2]);
    let length = geometry::norm(axis);
    if length > 0.0 { axis / length } else { axis }
}

/// Returns the rotation vector as the reference system computes it, with the wrong axis.
fn log(rotation: Rotation) -> Vector {
    axis(rotation) * geometry::to_axis_angle(rotation).1
}

pub(super) fn rotation_axis(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    Some(FaultyValue::value(axis(case.input(0)?)))
}

pub(super) fn quaternion(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    let wrong = geometry::exp(log(case.input(0)?));
    let parts = [wrong.i, wrong.j, wrong.k, wrong.w];
    Some(FaultyValue::value(*parts.get(case.port)?))
}

/// Models an interpolation of poses about the wrong axis.
pub(super) fn lerp(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    let (from, to, amount): (Pose, Pose, f64) = (case.input(0)?, case.input(1)?, case.input(2)?);
    let turn = log(from.rotation.inverse() * to.rotation) * amount;
    let way = to.translation.vector - from.translation.vector;
    let position = from.translation.vector + way * amount;
    let rotation = from.rotation * geometry::exp(turn);
    Some(FaultyValue::value(Pose::from_parts(
        position.into(),
        rotation,
    )))
}

/// Models an angular velocity about the wrong axis.
pub(super) fn twist_from_frames(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    let (from, to): (Pose, Pose) = (case.input(0)?, case.input(1)?);
    let turn = from.rotation * log(from.rotation.inverse() * to.rotation);
    let way = to.translation.vector - from.translation.vector;
    Some(FaultyValue::value(Twist {
        linear: way / case.dt,
        angular: turn / case.dt,
    }))
}

/// Models a step of the online trajectory with a rotation about the wrong axis.
pub(super) fn frame_otg(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    let (from, to): (Pose, Pose) = (case.input(0)?, case.input(2)?);
    let (velocity, goal) = (
        case.input(1).unwrap_or_default(),
        case.input(3).unwrap_or_default(),
    );
    let limits = Limits {
        velocity: (case.input(4)?, case.input(6)?),
        acceleration: (case.input(5)?, case.input(7)?),
    };
    let next = frame_otg::step(from, velocity, (to, goal), limits, case.dt, log);
    Some(if case.port == 0 {
        FaultyValue::value(crate::catalogue::frame::integrate(from, next, case.dt))
    } else {
        FaultyValue::value(next)
    })
}

/// Models a quaternion that is not normalised: the identity for small angles, not-a-number if w is not a cosine.
pub(super) fn from_quaternion(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    const NO_ROTATION: f64 = 0.99999;
    let axis = Vector::new(case.input(0)?, case.input(1)?, case.input(2)?);
    let (w, length): (f64, f64) = (case.input(3)?, geometry::norm(axis));
    if (w > NO_ROTATION && w <= 1.0) || length == 0.0 {
        return Some(FaultyValue::value(Rotation::identity()));
    }
    let turn = axis / length * (2.0 * libm::acos(w));
    Some(FaultyValue::value(geometry::exp(turn)))
}

/// Models the newest value instead of the mean: the weight 1/n is an integer division.
pub(super) fn newest(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    Some(FaultyValue::value::<Rotation>(case.input(0)?))
}

/// Models the neutral value of the type instead of the parameter `Value` before the first snapshot.
pub(super) fn neutral(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    if case.params.first().map(Value::slots) != case.computed {
        return None;
    }
    let PortType::Scalar(scalar) = case.desc.outputs.get(case.port)?.ty else {
        return None;
    };
    Some(match scalar {
        Scalar::Rotation => FaultyValue::value(Rotation::identity()),
        Scalar::Pose => FaultyValue::value(Pose::identity()),
        _ => FaultyValue {
            cells: [0; MAX_SLOTS],
            len: scalar.slots() as usize,
        },
    })
}

/// Models saturating conversion to 32-bit integers.
pub(super) fn saturated(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    let value: f64 = case.input(0)?;
    Some(FaultyValue::value(i64::from(value as i32)))
}

/// Models a wrapping 32-bit sum.
pub(super) fn wrapped_sum(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    wrapped(case, i32::wrapping_add)
}

/// Models a wrapping 32-bit product.
pub(super) fn wrapped_product(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    wrapped(case, i32::wrapping_mul)
}

fn wrapped(case: &DifferenceCase<'_>, operation: fn(i32, i32) -> i32) -> Option<FaultyValue> {
    let operand = |k| case.input::<i64>(k).and_then(|v| i32::try_from(v).ok());
    Some(FaultyValue::value(i64::from(operation(
        operand(0)?,
        operand(1)?,
    ))))
}

/// Models times in whole milliseconds, truncated.
pub(super) fn whole_milliseconds(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    const MILLISECOND: i64 = 1_000_000;
    let (time, delta): (Time, f64) = (case.input(0)?, case.input(1)?);
    let sum = (time.0 / MILLISECOND) as f64 + delta * 1000.0;
    Some(FaultyValue::value(Time(
        (sum as i64).checked_mul(MILLISECOND)?,
    )))
}

/// Models a first cycle in which the axis moved from position 0 within one period.
pub(super) fn otg_from_zero(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    if case.input::<f64>(1).is_some() {
        return None;
    }
    let position: f64 = case.input(0).unwrap_or(0.0);
    let goal = (case.input(3)?, case.input(4).unwrap_or(0.0));
    let from = (position, position / case.dt);
    let (position, velocity, acceleration) =
        otg::step(from, goal, case.input(5)?, case.input(6)?, case.dt);
    let outs = [position, velocity, acceleration];
    Some(FaultyValue::value(*outs.get(case.port)?))
}

/// Models a division by a maximum acceleration of 0.
pub(super) fn otg_without_acceleration(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    (case.input::<f64>(6)? == 0.0).then(|| FaultyValue::value(f64::NAN))
}

/// Models an input object that is compared with itself, so that no change is detected.
pub(super) fn no_edge(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    reads_input_object(case).then(|| FaultyValue::value(false))
}

/// Returns whether the first in-port reads a device. The inputs and outputs of devices are objects that change in
/// place.
fn reads_input_object(case: &DifferenceCase<'_>) -> bool {
    let source = case.sources.first().copied().flatten();
    source.is_some_and(|name| name.starts_with("IO::"))
}

/// Returns whether each part of the recorded value equals that part of the computed value or of a current value that
/// the primitive reads.
pub(super) fn aliased(
    case: &DifferenceCase<'_>,
    recorded: &[u64],
    same: &impl Fn(&[u64], &[u64]) -> bool,
) -> bool {
    let PortType::Scalar(scalar) = case.desc.outputs[case.port].ty else {
        return false;
    };
    if matches!(scalar, Scalar::Bool | Scalar::Real) && !reads_input_object(case) {
        return false;
    }
    let end = scalar.slots() as usize;
    let parts = match scalar {
        Scalar::Pose | Scalar::Twist => [0..3, 3..end],
        _ => [0..end, 0..end],
    };
    let current = || case.origins.iter().copied().chain(case.computed);
    let known = |part: &Range<usize>| current().any(|value| same_part(recorded, value, part, same));
    parts.iter().all(known)
        && case
            .origins
            .iter()
            .any(|value| value.len() == recorded.len())
}

/// Returns whether two values are equal in the slots of `part`, by the equality of whole values.
fn same_part(
    recorded: &[u64],
    value: &[u64],
    part: &Range<usize>,
    same: &impl Fn(&[u64], &[u64]) -> bool,
) -> bool {
    if value.len() != recorded.len() || value.len() > MAX_SLOTS {
        return false;
    }
    let mut mixed = [0; MAX_SLOTS];
    let mixed = &mut mixed[..recorded.len()];
    mixed.copy_from_slice(recorded);
    mixed[part.clone()].copy_from_slice(&value[part.clone()]);
    same(mixed, recorded)
}
