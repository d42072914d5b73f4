//! Braking of a whole arm: all axes come to rest within their limits, on a straight line in joint space if possible.

use super::limits::AxisState;
use rpi_kin::stop_profile::{StopProfile, VelocityState};
use rpi_kin::{AxisLimits, MAX_AXES};

/// Stop of an arm that brakes on its own: a stop profile for each axis, and the time since its start.
#[derive(Clone, Copy, Debug)]
pub(super) struct Brake {
    axes: [StopProfile; MAX_AXES],
    /// Time since the start of braking, in s.
    time: f64,
}

/// Maximum deviation of the accelerations of the axes from a common multiple of their velocities, as a fraction of the
/// acceleration limits, for a motion that counts as a straight line in joint space.
const STRAIGHTNESS_TOLERANCE: f64 = 1e-3;

impl Brake {
    /// Plans the stop from the states of all axes. An axis for which no stop profile is possible stops at once.
    pub(super) fn new<'a>(axes: impl Iterator<Item = (AxisState, &'a AxisLimits)> + Clone) -> Self {
        let mut stops = [StopProfile::default(); MAX_AXES];
        let along = braking_line(axes.clone());
        for (stop, (state, limits)) in stops.iter_mut().zip(axes) {
            *stop = match along {
                Some(line) => line.stop_of(&state),
                None => StopProfile::new(motion(&state), limits.acceleration, limits.jerk),
            }
            .unwrap_or_default();
        }
        Self {
            axes: stops,
            time: 0.0,
        }
    }

    /// Advances the time of the stop by `tick` (s). Returns the new velocity of each axis, rad/s.
    pub(super) fn advance(&mut self, tick: f64) -> impl Iterator<Item = f64> + '_ {
        self.time += tick;
        self.axes
            .iter()
            .map(|stop| stop.state_at(self.time).velocity)
    }

    /// True if all axes have been at rest for two ticks of `tick` seconds. Only then are the first and second
    /// differences of their positions zero, which the check of the next set-points uses.
    pub(super) fn is_finished(&self, tick: f64) -> bool {
        let stood = self.time - 2.0 * tick;
        self.axes.iter().all(|stop| stood >= stop.duration())
    }
}

/// Common stop of axes that move along a line in joint space: every axis follows the same profile, scaled by its
/// velocity.
#[derive(Clone, Copy)]
struct BrakingLine {
    /// Initial ratio of acceleration to velocity, 1/s.
    gain: f64,
    /// Maximum ratio of acceleration to velocity that every axis can follow, 1/s.
    acceleration: f64,
    /// Maximum ratio of jerk to velocity that every axis can follow, 1/s².
    jerk: f64,
}

impl BrakingLine {
    fn stop_of(&self, state: &AxisState) -> Option<StopProfile> {
        let speed = state.velocity.abs();
        if speed == 0.0 {
            return Some(StopProfile::default());
        }
        let start = VelocityState {
            velocity: state.velocity,
            acceleration: self.gain * state.velocity,
        };
        StopProfile::new(start, self.acceleration * speed, self.jerk * speed)
    }
}

/// Returns the common stop of axes that move along a line in joint space; `None` if their accelerations are not in
/// proportion to their velocities.
fn braking_line<'a>(
    axes: impl Iterator<Item = (AxisState, &'a AxisLimits)> + Clone,
) -> Option<BrakingLine> {
    let by_speed = |state: &AxisState| state.velocity.abs();
    let states = axes.clone().map(|(state, _)| state);
    let fastest = states.max_by(|one, other| by_speed(one).total_cmp(&by_speed(other)))?;
    let gain = if fastest.velocity == 0.0 {
        0.0
    } else {
        fastest.acceleration / fastest.velocity
    };
    let mut line = BrakingLine {
        gain,
        acceleration: f64::INFINITY,
        jerk: f64::INFINITY,
    };
    for (state, limits) in axes {
        let off = state.acceleration - gain * state.velocity;
        if off.abs() > STRAIGHTNESS_TOLERANCE * limits.acceleration {
            return None;
        }
        line.acceleration = line
            .acceleration
            .min(limits.acceleration / by_speed(&state));
        line.jerk = line.jerk.min(limits.jerk / by_speed(&state));
    }
    Some(line)
}

fn motion(state: &AxisState) -> VelocityState {
    VelocityState {
        velocity: state.velocity,
        acceleration: state.acceleration,
    }
}
