//! Straight line in joint space: one motion, scaled for each axis.

use super::axis::AxisPlanner;
use super::limits::AxisLimits;
use super::motion::at_one_time;
use super::profile::AxisProfile;
use super::velocity_axis::VelocityPlanner;
use rpi_kin::state_to_rest::AxisState;

/// Deviation from a straight line in joint space that counts as rounding, as a share of the largest value of all axes.
const SLACK: f64 = 1e-10;

/// Values of one axis: displacement, velocity and acceleration at the start, velocity and acceleration at the target.
type Row = [f64; 5];

/// Plans the time-optimal motion to a target position on a straight line in joint space. Returns `None` if
/// displacements, velocities and accelerations of the axes are not all in one proportion.
pub(super) fn straight_line<const N: usize>(
    start: &[AxisState; N],
    target: &[AxisState; N],
    limits: &[AxisLimits; N],
    minimum_duration: f64,
) -> Option<[AxisProfile; N]> {
    let rows = rows(start, target);
    let (leading, shares) = proportions(&rows)?;
    let common = common_limits(&shares, limits)?;
    let (from, to) = leading_states(&rows[leading]);
    common.check_target(&to).ok()?;
    let planner = AxisPlanner::new(from, to, &common);
    let [line] = at_one_time(&[planner], minimum_duration)?;
    let scale = |axis| scaled_profile(start[axis], target[axis], &line, shares[axis]);
    Some(core::array::from_fn(|axis| {
        scale(axis).finished(line.duration())
    }))
}

/// Plans the time-optimal motion to a target velocity on a straight line in joint space. Returns `None` if velocities
/// and accelerations of the axes are not all in one proportion.
pub(super) fn straight_change<const N: usize>(
    start: &[AxisState; N],
    target: &[AxisState; N],
    limits: &[AxisLimits; N],
    minimum_duration: f64,
) -> Option<[AxisProfile; N]> {
    let rows = rows(start, target).map(|[_, rest @ ..]| {
        let [v0, a0, vf, af] = rest;
        [vf - v0, v0, a0, vf, af]
    });
    let (leading, shares) = proportions(&rows)?;
    let common = common_limits(&shares, limits)?;
    let (from, to) = leading_states(&rows[leading]);
    common.check_acceleration(&to).ok()?;
    let planner = VelocityPlanner::new(from, to, &common);
    let [line] = at_one_time(&[planner], minimum_duration)?;
    let scale = |axis| scaled_profile(start[axis], target[axis], &line, shares[axis]);
    Some(core::array::from_fn(|axis| {
        scale(axis).released(line.duration())
    }))
}

fn rows<const N: usize>(start: &[AxisState; N], target: &[AxisState; N]) -> [Row; N] {
    core::array::from_fn(|axis| {
        let (from, to) = (&start[axis], &target[axis]);
        [
            to.position - from.position,
            from.velocity,
            from.acceleration,
            to.velocity,
            to.acceleration,
        ]
    })
}

/// Returns the states of the leading axis at the start, where its position is 0, and at the target.
fn leading_states([distance, v0, a0, vf, af]: &Row) -> (AxisState, AxisState) {
    let state = |position: f64, velocity: &f64, acceleration: &f64| AxisState {
        position,
        velocity: *velocity,
        acceleration: *acceleration,
    };
    (state(0.0, v0, a0), state(*distance, vf, af))
}

fn scaled_profile(
    start: AxisState,
    target: AxisState,
    line: &AxisProfile,
    share: f64,
) -> AxisProfile {
    let mut profile = AxisProfile::standing(start, target);
    for phase in line.phases() {
        profile.push(phase.duration, phase.jerk * share);
    }
    profile
}

/// Returns the axis with the largest value of all (the leading axis), and the motion of each axis as a multiple of it.
/// `None` if the axes are not in one proportion, or if no value differs from 0.
fn proportions<const N: usize>(rows: &[Row; N]) -> Option<(usize, [f64; N])> {
    let largest = |k: usize| {
        rows.iter().map(|row| row[k].abs()).enumerate().fold(
            (0, 0.0),
            |best: (usize, f64), next| {
                if next.1 > best.1 { next } else { best }
            },
        )
    };
    let ((leading, size), kind) =
        (0..5)
            .map(|k| (largest(k), k))
            .fold(
                ((0, 0.0), 0),
                |best, next| {
                    if next.0.1 > best.0.1 { next } else { best }
                },
            );
    if size == 0.0 {
        return None;
    }
    let shares = core::array::from_fn(|axis| rows[axis][kind] / rows[leading][kind]);
    let is_proportional = (0..5).all(|k| {
        let slack = SLACK * largest(k).1;
        rows.iter()
            .zip(&shares)
            .all(|(row, share)| (row[k] - share * rows[leading][k]).abs() <= slack)
    });
    is_proportional.then_some((leading, shares))
}

/// Returns the limits for the leading axis by which all axes keep their limits, for the motions of the axes as
/// multiples (`shares`) of its motion. `None` if no axis moves.
fn common_limits<const N: usize>(
    shares: &[f64; N],
    limits: &[AxisLimits; N],
) -> Option<AxisLimits> {
    let moving = shares
        .iter()
        .zip(limits)
        .filter(|(share, _)| **share != 0.0);
    moving
        .map(|(share, limits)| scaled(limits, 1.0 / share))
        .reduce(|a, b| AxisLimits {
            max_velocity: a.max_velocity.min(b.max_velocity),
            min_velocity: a.min_velocity.max(b.min_velocity),
            max_acceleration: a.max_acceleration.min(b.max_acceleration),
            min_acceleration: a.min_acceleration.max(b.min_acceleration),
            max_jerk: a.max_jerk.min(b.max_jerk),
        })
}

fn scaled(limits: &AxisLimits, factor: f64) -> AxisLimits {
    let range = |max: f64, min: f64| {
        let (one, other) = (max * factor, min * factor);
        (one.max(other), one.min(other))
    };
    let (max_velocity, min_velocity) = range(limits.max_velocity, limits.min_velocity);
    let (max_acceleration, min_acceleration) =
        range(limits.max_acceleration, limits.min_acceleration);
    AxisLimits {
        max_velocity,
        min_velocity,
        max_acceleration,
        min_acceleration,
        max_jerk: limits.max_jerk * factor.abs(),
    }
}
