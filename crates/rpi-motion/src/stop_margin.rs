//! Distance that an axis needs to stop.

use rpi_kin::AxisLimits;

/// Returns the distances (rad, not negative) that an axis with a velocity (rad/s) and an acceleration (rad/s²) still
/// covers downwards and upwards if it stops with its limits: how far from the ends of its range it must be.
///
/// They are those of the time-optimal stop: the acceleration first decays at the maximum jerk, and the axis then stops
/// from the velocity that it has there.
#[must_use]
pub fn stopping_distances(velocity: f64, acceleration: f64, limits: &AxisLimits) -> (f64, f64) {
    (
        upwards(-velocity, -acceleration, limits),
        upwards(velocity, acceleration, limits),
    )
}

fn upwards(velocity: f64, acceleration: f64, limits: &AxisLimits) -> f64 {
    let (most, jerk) = (limits.acceleration, limits.jerk);
    let (mut covered, mut speed) = (0.0, velocity);
    if acceleration > 0.0 {
        let time = acceleration / jerk;
        covered = time * (velocity + acceleration * time / 3.0);
        speed = velocity + acceleration * time / 2.0;
    }
    if speed <= 0.0 {
        return covered.max(0.0);
    }
    // An acceleration that already brakes shortens the stop; this bound does without it.
    let ramp = if speed * jerk >= most * most {
        speed / most + most / jerk
    } else {
        2.0 * libm::sqrt(speed / jerk)
    };
    covered.max(0.0) + speed * ramp / 2.0
}
