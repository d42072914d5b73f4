//! Models of faults of the reference system. A recorded value that equals the result of a model is explained by the
//! fault.

use super::{DifferenceCase, FaultyValue, MAX_SLOTS};
use crate::catalogue::frame_otg::{self, Limits};
use crate::catalogue::otg;
use crate::geometry;
use crate::value_types::{Pose, Rotation, Time, Twist, Vector};
use core::ops::Range;
use rpi_image::{PortType, Scalar, Value};

/// Models the fault that swaps sine and cosine, for a primitive that should compute the sine: returns the cosine of the
/// recorded input.
pub(super) fn sine_as_cosine(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    Some(FaultyValue::value(rpi_math::cos(case.input(0)?)))
}

/// Models the fault that swaps sine and cosine, for a primitive that should compute the cosine: returns the sine of the
/// recorded input.
pub(super) fn cosine_as_sine(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    Some(FaultyValue::value(rpi_math::sin(case.input(0)?)))
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

/// Models the faulty interpolation of poses: the orientation turns about the wrong axis of [`log`].
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

/// Models the faulty velocity between two poses: the angular part is about the wrong axis of [`log`].
pub(super) fn twist_from_frames(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    let (from, to): (Pose, Pose) = (case.input(0)?, case.input(1)?);
    let turn = from.rotation * log(from.rotation.inverse() * to.rotation);
    let way = to.translation.vector - from.translation.vector;
    Some(FaultyValue::value(Twist {
        linear: way / case.dt,
        angular: turn / case.dt,
    }))
}

/// Models the faulty step of the online trajectory generation for poses: it turns about the wrong axis of [`log`].
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

/// Models the faulty rotation from a quaternion that is not normalised: the identity for small angles, not-a-number if
/// w is not a cosine.
pub(super) fn from_quaternion(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    const NO_ROTATION: f64 = 0.99999;
    let axis = Vector::new(case.input(0)?, case.input(1)?, case.input(2)?);
    let (w, length): (f64, f64) = (case.input(3)?, geometry::norm(axis));
    if (w > NO_ROTATION && w <= 1.0) || length == 0.0 {
        return Some(FaultyValue::value(Rotation::identity()));
    }
    let turn = axis / length * (2.0 * rpi_math::acos(w));
    Some(FaultyValue::value(geometry::exp(turn)))
}

/// Models the faulty mean of rotations, which is the newest rotation: its weight 1/n is an integer division.
pub(super) fn newest(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    Some(FaultyValue::value::<Rotation>(case.input(0)?))
}

/// Models the fault of a sample-and-hold primitive that outputs the neutral value of the type, instead of its parameter
/// `Value`, before the first sample.
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

/// Models the faulty conversion of a real to an integer, which saturates at 32 bits.
pub(super) fn saturated(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    let value: f64 = case.input(0)?;
    Some(FaultyValue::value(i64::from(value as i32)))
}

/// Models the faulty sum of integers, which wraps at 32 bits.
pub(super) fn wrapped_sum(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    wrapped(case, i32::wrapping_add)
}

/// Models the faulty product of integers, which wraps at 32 bits.
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

/// Models the faulty sum of a time and a duration, which is computed in whole milliseconds, truncated.
pub(super) fn whole_milliseconds(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    const MILLISECOND: i64 = 1_000_000;
    let (time, delta): (Time, f64) = (case.input(0)?, case.input(1)?);
    let sum = (time.0 / MILLISECOND) as f64 + delta * 1000.0;
    Some(FaultyValue::value(Time(
        (sum as i64).checked_mul(MILLISECOND)?,
    )))
}

/// Models the faulty first cycle of a trajectory generation without a velocity: it computes the velocity of an
/// axis that moves from position 0 within one period.
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

/// Models the faulty trajectory generation for a maximum acceleration of 0: a division by 0 gives not-a-number.
pub(super) fn otg_without_acceleration(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    (case.input::<f64>(6)? == 0.0).then(|| FaultyValue::value(f64::NAN))
}

/// Models the faulty edge detection on an input of a device: it compares an object with itself and never detects an
/// edge.
pub(super) fn no_edge(case: &DifferenceCase<'_>) -> Option<FaultyValue> {
    reads_input_object(case).then(|| FaultyValue::value(false))
}

/// Returns true if the first in-port reads an input or output of a device. In the reference system, these are objects
/// that change in place.
fn reads_input_object(case: &DifferenceCase<'_>) -> bool {
    let source = case.sources.first().copied().flatten();
    source.is_some_and(|name| name.starts_with("IO::"))
}

/// Returns true if each part of the recorded value equals the same part of the computed value or of a current value
/// that the primitive reads. Parts are position and orientation of a pose, linear and angular velocity of a twist, else
/// the whole value.
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

/// Returns true if two values are equal in the slots of `part`. `same` compares whole values, so the rest is made equal
/// first.
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
