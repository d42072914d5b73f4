//! Fastest return of a start state into the limits.
//!
//! A state is within the limits if its velocity is, its acceleration is, and its velocity stays so while the
//! acceleration decays with the maximum jerk. All values are divided by the maximum jerk.

use super::family::Ends;

/// Share by which a start may exceed a limit of the velocity by rounding without counting as outside of it.
const SLACK: f64 = 1e-12;

/// Return of a start state into the limits: up to four phases (duration, sign of the jerk), and the state at its end.
/// All quantities are divided by the maximum jerk.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Return {
    pub(super) phases: [(f64, f64); 4],
    pub(super) position: f64,
    pub(super) velocity: f64,
    pub(super) acceleration: f64,
}

impl Return {
    pub(super) fn duration(&self) -> f64 {
        self.phases.iter().map(|phase| phase.0).sum()
    }

    fn add(&mut self, slot: usize, duration: f64, jerk: f64) {
        let time = duration.max(0.0);
        self.phases[slot] = (time, jerk);
        let (v, a) = (self.velocity, self.acceleration);
        self.position += time * (v + time * (a / 2.0 + time * jerk / 6.0));
        self.velocity = v + time * (a + time * jerk / 2.0);
        self.acceleration = a + time * jerk;
    }
}

/// Returns the fastest return of the start into the limits. Its duration is 0 if the start is within them.
pub(super) fn return_into_limits(ends: &Ends) -> Return {
    let mut way = Return {
        velocity: ends.start_velocity,
        acceleration: ends.start_acceleration,
        ..Return::default()
    };
    let (high, low) = (ends.max_acceleration, ends.min_acceleration);
    if way.acceleration > high {
        way.add(0, way.acceleration - high, -1.0);
        way.acceleration = high;
    } else if way.acceleration < low {
        way.add(0, low - way.acceleration, 1.0);
        way.acceleration = low;
    }
    if is_too_fast(&way, ends.max_velocity, ends.min_velocity) {
        slow_down(&mut way, ends);
    } else {
        let mirror = ends.mirrored();
        let mut mirrored = mirrored(way);
        if is_too_fast(&mirrored, mirror.max_velocity, mirror.min_velocity) {
            slow_down(&mut mirrored, &mirror);
            way = self::mirrored(mirrored);
        }
    }
    way
}

fn mirrored(way: Return) -> Return {
    Return {
        phases: way.phases.map(|(time, jerk)| (time, -jerk)),
        position: -way.position,
        velocity: -way.velocity,
        acceleration: -way.acceleration,
    }
}

fn is_too_fast(way: &Return, max_velocity: f64, min_velocity: f64) -> bool {
    let (v, a) = (way.velocity, way.acceleration);
    let highest = max_velocity * (1.0 + SLACK);
    if a > 0.0 {
        return v + a * a / 2.0 > highest;
    }
    // With a deceleration that cannot end before the minimum velocity, the state is too slow instead.
    v > highest && v - a * a / 2.0 >= min_velocity * (1.0 + SLACK)
}

/// Adds to `way` the fastest fall of the velocity to its maximum. The acceleration at its end must be able to decay
/// before the minimum velocity is reached.
fn slow_down(way: &mut Return, ends: &Ends) {
    let (v, a) = (way.velocity, way.acceleration);
    let coasting = v + a * a / 2.0;
    let range = ends.max_velocity - ends.min_velocity;
    let steepest = ends.min_acceleration;
    let directly = -libm::sqrt((2.0 * (coasting - ends.max_velocity)).max(0.0));
    let allowed = -libm::sqrt(2.0 * range);
    if directly >= steepest.max(allowed) {
        way.add(1, a - directly, -1.0);
        way.acceleration = directly;
    } else if allowed <= steepest {
        way.add(1, a - steepest, -1.0);
        way.acceleration = steepest;
        way.add(2, (way.velocity - ends.max_velocity) / -steepest, 0.0);
    } else {
        let trough = -libm::sqrt((coasting - ends.min_velocity).max(0.0));
        let trough = trough.max(steepest);
        way.add(1, a - trough, -1.0);
        way.acceleration = trough;
        let line = ends.min_velocity + trough * trough / 2.0;
        way.add(2, (way.velocity - line) / -trough, 0.0);
        way.add(3, allowed - way.acceleration, 1.0);
        way.acceleration = allowed;
    }
    way.velocity = ends.max_velocity;
}
