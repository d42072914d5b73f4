//! Entry into the curve of a new chunk: the decay of what the axes have and the curve does not have.

use super::curve::{Curve, CurvePoint};
use super::feedback;
use super::residual::Residual;
use super::state::{difference, is_within};
use crate::Arm;
use rpi_kin::MAX_AXES;
use rpi_kin::state_to_rest::{AxisState, Bounds};

/// Durations of the decay that are tried, s.
const DURATIONS: [f64; 20] = [
    0.04, 0.055, 0.075, 0.1, 0.125, 0.15, 0.18, 0.22, 0.27, 0.33, 0.4, 0.48, 0.58, 0.7, 0.85, 1.05,
    1.4, 2.0, 2.8, 4.0,
];

/// Number of samples of a decay.
const SAMPLES: u32 = 16;

/// Differences of position (rad), velocity (rad/s) and acceleration (rad/s²) that need no decay of their own.
const SMALL: [f64; 3] = [1e-9, 1e-7, 1e-5];

/// Distance by which a decay may lead away from the curve farther than the axis needs for braking, rad. A long decay of an
/// acceleration `a` in the time `T` leads away by `a T² / 58`: up to a radian where the limits forbid a short one.
const DETOUR: f64 = 0.02;

/// Number of samples of a decay that are searched for its largest difference.
const DETOUR_SAMPLES: u32 = 32;

/// Returns true if a decay of an axis with `bounds` leads it far away from the curve: farther than the axis needs for braking the
/// difference at the start.
pub(super) fn is_detour(bounds: &Bounds, decay: &Residual) -> bool {
    let room = DETOUR + feedback::reach_with(bounds, &decay.at(0.0).state, 1.0);
    (0..DETOUR_SAMPLES).any(|k| {
        let time = decay.duration() * f64::from(k) / f64::from(DETOUR_SAMPLES);
        decay.at(time).state.position.abs() > room
    })
}

/// Returns the state of an axis that follows `point` of a curve whose time passes with `law`.
pub(super) fn on_curve(point: &CurvePoint, axis: usize, law: &AxisState) -> AxisState {
    AxisState {
        position: point.position[axis],
        velocity: point.first[axis] * law.velocity,
        acceleration: point.first[axis] * law.acceleration
            + point.second[axis] * law.velocity * law.velocity,
    }
}

/// Plans the entry of each axis from `state` into a curve whose time passes with `law`: the shortest decay with which the sum
/// keeps the `bounds`. An axis without one has no decay; it is then led on to the curve in each cycle.
pub(super) fn plan(
    arm: &Arm,
    bounds: &[Bounds; MAX_AXES],
    curve: &Curve,
    law: &AxisState,
    state: &[AxisState; MAX_AXES],
) -> [Residual; MAX_AXES] {
    let start = curve.at(law.position);
    let differences: [AxisState; MAX_AXES] =
        core::array::from_fn(|axis| difference(&state[axis], &on_curve(&start, axis, law)));
    let mut planned = [Residual::default(); MAX_AXES];
    let mut open: [bool; MAX_AXES] =
        core::array::from_fn(|axis| axis < arm.axes() && !is_within(&differences[axis], SMALL));
    for duration in DURATIONS {
        if !open.contains(&true) {
            break;
        }
        let decays = differences.map(|difference| Residual::new(difference, duration));
        let mut is_within = open;
        for k in 0..=SAMPLES {
            // Not the very end, where there is no jerk any more.
            let time = duration * f64::from(k) / f64::from(SAMPLES) * (1.0 - 1e-9);
            let at = curve.at(law.position + law.velocity * time);
            for axis in (0..arm.axes()).filter(|axis| open[*axis]) {
                is_within[axis] &=
                    keeps(&bounds[axis], &at, axis, law.velocity, &decays[axis], time);
            }
        }
        for axis in (0..arm.axes()).filter(|axis| is_within[*axis]) {
            planned[axis] = decays[axis];
            open[axis] = false;
        }
    }
    planned
}

/// Returns true if the sum of curve and decay keeps the bounds of an axis at a time (s) since the entry.
fn keeps(
    bounds: &Bounds,
    at: &CurvePoint,
    axis: usize,
    rate: f64,
    decay: &Residual,
    time: f64,
) -> bool {
    let decay = decay.at(time);
    let velocity = at.first[axis] * rate + decay.state.velocity;
    let acceleration = at.second[axis] * rate * rate + decay.state.acceleration;
    let jerk = at.third[axis] * rate * rate * rate + decay.jerk;
    velocity.abs() <= bounds.speed
        && acceleration.abs() <= bounds.acceleration
        && jerk.abs() <= bounds.jerk
}
