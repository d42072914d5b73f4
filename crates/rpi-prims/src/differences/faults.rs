//! What the reference computes where it is wrong, so that a recorded value can be recognised as the fault.

use super::{Case, WIDEST, Wrong};
use crate::catalogue::frame_otg::{self, Limits};
use crate::catalogue::otg;
use crate::flow::{Pose, Rotation, Time, Twist, Vector};
use crate::geometry;
use core::ops::Range;
use rpi_image::{PortType, Scalar, Value};

/// Sine and cosine are exchanged.
pub(super) fn cosine(case: &Case<'_>) -> Option<Wrong> {
    Some(Wrong::value(libm::cos(case.input(0)?)))
}

/// Sine and cosine are exchanged.
pub(super) fn sine(case: &Case<'_>) -> Option<Wrong> {
    Some(Wrong::value(libm::sin(case.input(0)?)))
}

/// The last component of the axis is taken from the wrong elements of the matrix.
fn axis(rotation: Rotation) -> Vector {
    let m = geometry::matrix(rotation);
    let axis = Vector::new(m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][2]);
    let length = geometry::norm(axis);
    if length > 0.0 { axis / length } else { axis }
}

/// Axis times angle with that axis.
fn log(rotation: Rotation) -> Vector {
    axis(rotation) * geometry::to_axis_angle(rotation).1
}

pub(super) fn rotation_axis(case: &Case<'_>) -> Option<Wrong> {
    Some(Wrong::value(axis(case.input(0)?)))
}

pub(super) fn quaternion(case: &Case<'_>) -> Option<Wrong> {
    let wrong = geometry::exp(log(case.input(0)?));
    let parts = [wrong.i, wrong.j, wrong.k, wrong.w];
    Some(Wrong::value(*parts.get(case.port)?))
}

/// Interpolation about the wrong axis.
pub(super) fn lerp(case: &Case<'_>) -> Option<Wrong> {
    let (from, to, amount): (Pose, Pose, f64) = (case.input(0)?, case.input(1)?, case.input(2)?);
    let turn = log(from.rotation.inverse() * to.rotation) * amount;
    let way = to.translation.vector - from.translation.vector;
    let position = from.translation.vector + way * amount;
    let rotation = from.rotation * geometry::exp(turn);
    Some(Wrong::value(Pose::from_parts(position.into(), rotation)))
}

/// Angular velocity about the wrong axis.
pub(super) fn twist_from_frames(case: &Case<'_>) -> Option<Wrong> {
    let (from, to): (Pose, Pose) = (case.input(0)?, case.input(1)?);
    let turn = from.rotation * log(from.rotation.inverse() * to.rotation);
    let way = to.translation.vector - from.translation.vector;
    Some(Wrong::value(Twist {
        linear: way / case.dt,
        angular: turn / case.dt,
    }))
}

/// A way of rotation about the wrong axis.
pub(super) fn frame_otg(case: &Case<'_>) -> Option<Wrong> {
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
        Wrong::value(crate::catalogue::frame::moved(from, next, case.dt))
    } else {
        Wrong::value(next)
    })
}

/// Not scaled to unit length; no rotation at all where the angle is small, and not a number where w is no cosine.
pub(super) fn from_quaternion(case: &Case<'_>) -> Option<Wrong> {
    const NO_ROTATION: f64 = 0.99999;
    let axis = Vector::new(case.input(0)?, case.input(1)?, case.input(2)?);
    let (w, length): (f64, f64) = (case.input(3)?, geometry::norm(axis));
    if (w > NO_ROTATION && w <= 1.0) || length == 0.0 {
        return Some(Wrong::value(Rotation::identity()));
    }
    let turn = axis / length * (2.0 * libm::acos(w));
    Some(Wrong::value(geometry::exp(turn)))
}

/// The newest value instead of the mean: its share is divided as an integer.
pub(super) fn newest(case: &Case<'_>) -> Option<Wrong> {
    Some(Wrong::value::<Rotation>(case.input(0)?))
}

/// Before the first snapshot the type's neutral value instead of the parameter.
pub(super) fn neutral(case: &Case<'_>) -> Option<Wrong> {
    if case.params.first().map(Value::cells) != case.computed {
        return None;
    }
    let PortType::One(scalar) = case.desc.outputs.get(case.port)?.ty else {
        return None;
    };
    Some(match scalar {
        Scalar::Rotation => Wrong::value(Rotation::identity()),
        Scalar::Pose => Wrong::value(Pose::identity()),
        _ => Wrong {
            cells: [0; WIDEST],
            len: scalar.cells() as usize,
        },
    })
}

/// 32-bit integers, saturated.
pub(super) fn saturated(case: &Case<'_>) -> Option<Wrong> {
    let value: f64 = case.input(0)?;
    Some(Wrong::value(i64::from(value as i32)))
}

/// 32-bit integers, wrapped.
pub(super) fn wrapped_sum(case: &Case<'_>) -> Option<Wrong> {
    wrapped(case, i32::wrapping_add)
}

/// 32-bit integers, wrapped.
pub(super) fn wrapped_product(case: &Case<'_>) -> Option<Wrong> {
    wrapped(case, i32::wrapping_mul)
}

fn wrapped(case: &Case<'_>, operation: fn(i32, i32) -> i32) -> Option<Wrong> {
    let operand = |k| case.input::<i64>(k).and_then(|v| i32::try_from(v).ok());
    Some(Wrong::value(i64::from(operation(operand(0)?, operand(1)?))))
}

/// Times are whole milliseconds, truncated.
pub(super) fn whole_milliseconds(case: &Case<'_>) -> Option<Wrong> {
    const MILLISECOND: i64 = 1_000_000;
    let (time, delta): (Time, f64) = (case.input(0)?, case.input(1)?);
    let sum = (time.0 / MILLISECOND) as f64 + delta * 1000.0;
    Some(Wrong::value(Time((sum as i64).checked_mul(MILLISECOND)?)))
}

/// In its first cycle it takes the axis to have come from 0 within the period.
pub(super) fn otg_from_zero(case: &Case<'_>) -> Option<Wrong> {
    if case.input::<f64>(1).is_some() {
        return None;
    }
    let position: f64 = case.input(0).unwrap_or(0.0);
    let goal = (case.input(3)?, case.input(4).unwrap_or(0.0));
    let from = (position, position / case.dt);
    let (position, velocity, acceleration) =
        otg::step(from, goal, case.input(5)?, case.input(6)?, case.dt);
    let outs = [position, velocity, acceleration];
    Some(Wrong::value(*outs.get(case.port)?))
}

/// Divides by the largest acceleration, 0 or not.
pub(super) fn otg_without_acceleration(case: &Case<'_>) -> Option<Wrong> {
    (case.input::<f64>(6)? == 0.0).then(|| Wrong::value(f64::NAN))
}

/// An input object is compared with itself, so that no change is ever seen.
pub(super) fn no_edge(case: &Case<'_>) -> Option<Wrong> {
    reads_input_object(case).then(|| Wrong::value(false))
}

/// Inputs and outputs of devices are single objects that change in place.
fn reads_input_object(case: &Case<'_>) -> bool {
    let source = case.sources.first().copied().flatten();
    source.is_some_and(|name| name.starts_with("IO::"))
}

/// True if each part of the recorded value is that of the computed one or of a current value that the primitive reads.
pub(super) fn aliased(
    case: &Case<'_>,
    recorded: &[u64],
    same: &impl Fn(&[u64], &[u64]) -> bool,
) -> bool {
    let PortType::One(scalar) = case.desc.outputs[case.port].ty else {
        return false;
    };
    if matches!(scalar, Scalar::Bool | Scalar::Real) && !reads_input_object(case) {
        return false;
    }
    let end = scalar.cells() as usize;
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

/// True if two values agree in some of their cells, judged by the equality of whole values.
fn same_part(
    recorded: &[u64],
    value: &[u64],
    part: &Range<usize>,
    same: &impl Fn(&[u64], &[u64]) -> bool,
) -> bool {
    if value.len() != recorded.len() || value.len() > WIDEST {
        return false;
    }
    let mut mixed = [0; WIDEST];
    let mixed = &mut mixed[..recorded.len()];
    mixed.copy_from_slice(recorded);
    mixed[part.clone()].copy_from_slice(&value[part.clone()]);
    same(mixed, recorded)
}
