//! Distance that an axis needs to stop.

use rpi_kin::AxisLimits;

/// Returns the distances (rad, not negative) that an axis with this velocity (rad/s) and acceleration (rad/s²) still
/// covers downwards and upwards if it stops with its limits: its minimum distances from the ends of its range.
///
/// They are those of the time-optimal stop: the acceleration first decays at the maximum jerk, and the axis then stops
/// from the velocity that it has reached.
#[must_use]
pub fn stopping_distances(velocity: f64, acceleration: f64, limits: &AxisLimits) -> (f64, f64) {
    (
        upwards(-velocity, -acceleration, limits),
        upwards(velocity, acceleration, limits),
    )
}

fn upwards(velocity: f64, acceleration: f64, limits: &AxisLimits) -> f64 {
    let jerk = limits.jerk;
    let (mut covered, mut speed) = (0.0, velocity);
    if acceleration > 0.0 {
        let time = acceleration / jerk;
        covered = time * (velocity + acceleration * time / 3.0);
        speed = velocity + acceleration * time / 2.0;
    }
    // An acceleration that already brakes shortens the stop; this bound does without it.
    covered.max(0.0) + without_acceleration(speed, limits)
}

/// Returns the distance (rad) of the stop from a velocity (rad/s) without an acceleration; 0 if it leads away.
fn without_acceleration(velocity: f64, limits: &AxisLimits) -> f64 {
    let (most, jerk) = (limits.acceleration, limits.jerk);
    if velocity <= 0.0 {
        return 0.0;
    }
    let duration = if velocity * jerk >= most * most {
        velocity / most + most / jerk
    } else {
        2.0 * libm::sqrt(velocity / jerk)
    };
    velocity * duration / 2.0
}

/// Returns the distances (rad, not negative) that an axis with this velocity (rad/s) and acceleration (rad/s²) still
/// covers downwards and upwards in the time-optimal stop: as [`stopping_distances`], but exact for an axis that already
/// brakes.
#[must_use]
pub fn exact_stopping_distances(
    velocity: f64,
    acceleration: f64,
    limits: &AxisLimits,
) -> (f64, f64) {
    (
        exactly_upwards(-velocity, -acceleration, limits),
        exactly_upwards(velocity, acceleration, limits),
    )
}

fn exactly_upwards(velocity: f64, acceleration: f64, limits: &AxisLimits) -> f64 {
    let jerk = limits.jerk;
    if acceleration >= 0.0 || velocity <= 0.0 {
        return upwards(velocity, acceleration, limits);
    }
    let lost = acceleration * acceleration / (2.0 * jerk);
    if lost < velocity {
        // The stop is the rest of one that began without acceleration, this time ago, at a velocity higher by `lost`.
        let time = -acceleration / jerk;
        let covered = time * (velocity + lost - jerk * time * time / 6.0);
        return without_acceleration(velocity + lost, limits) - covered;
    }
    // The axis turns back before its acceleration has decayed.
    let root = libm::sqrt(acceleration * acceleration - 2.0 * jerk * velocity);
    let time = (-acceleration - root) / jerk;
    time * (velocity + time * (acceleration / 2.0 + time * jerk / 6.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::online::{AxisLimits as OnlineLimits, MotionOptions, OnlineMotion};
    use rpi_kin::Range;
    use rpi_kin::state_to_rest::{AxisState, Bounds};

    const LIMITS: AxisLimits = AxisLimits {
        position: Range::symmetric(1e3),
        velocity: 6.0,
        acceleration: 12.0,
        jerk: 120.0,
    };

    /// Highest position of the time-optimal stop from position 0, as the online generator plans it.
    fn planned(velocity: f64, acceleration: f64) -> f64 {
        let bounds = Bounds {
            speed: LIMITS.velocity,
            acceleration: LIMITS.acceleration,
            jerk: LIMITS.jerk,
        };
        let start = [AxisState {
            position: 0.0,
            velocity,
            acceleration,
        }];
        let rest = [AxisState::default()];
        let limits = [OnlineLimits::from(bounds)];
        let stop =
            OnlineMotion::to_velocity(&start, &rest, &limits, MotionOptions::default()).unwrap();
        stop.axes()[0].position_extrema().max
    }

    #[test]
    fn distances_are_those_of_the_planned_stop() {
        for k in 0..400 {
            let velocity = 5.9 * rpi_math::sin(f64::from(k) * 1.7);
            let acceleration = 11.9 * rpi_math::sin(f64::from(k) * 0.37);
            let (_, above) = exact_stopping_distances(velocity, acceleration, &LIMITS);
            let wanted = planned(velocity, acceleration);
            assert!(
                (above - wanted).abs() < 1e-9,
                "{velocity} {acceleration}: {above} {wanted}"
            );
            let (_, bound) = stopping_distances(velocity, acceleration, &LIMITS);
            assert!(bound >= above - 1e-12);
        }
    }
}
