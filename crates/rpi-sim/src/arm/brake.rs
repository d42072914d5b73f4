//! The arm's own stop: all axes to rest, each within its limits, on a straight line through the joints where it can.

use super::guard::State;
use rpi_kin::stop::{Motion, Stop};
use rpi_kin::{AxisLimits, MAX_AXES};

/// An arm on its way to rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Brake {
    axes: [Stop; MAX_AXES],
    /// Time since it began, in s.
    time: f64,
}

/// How far accelerations may be from proportional to the velocities for the line to count as straight, as a share of the
/// acceleration limits.
const STRAIGHT: f64 = 1e-3;

impl Brake {
    /// From the states of all axes. An axis whose numbers allow no way to rest stops dead.
    pub(super) fn new<'a>(axes: impl Iterator<Item = (State, &'a AxisLimits)> + Clone) -> Self {
        let mut stops = [Stop::default(); MAX_AXES];
        let along = line(axes.clone());
        for (stop, (state, limits)) in stops.iter_mut().zip(axes) {
            *stop = match along {
                Some(line) => line.stop_of(&state),
                None => Stop::new(motion(&state), limits.acceleration, limits.jerk),
            }
            .unwrap_or_default();
        }
        Self {
            axes: stops,
            time: 0.0,
        }
    }

    /// Lets `tick` seconds pass; the velocity of each axis from then on.
    pub(super) fn pass(&mut self, tick: f64) -> impl Iterator<Item = f64> + '_ {
        self.time += tick;
        self.axes.iter().map(|stop| stop.at(self.time).velocity)
    }

    /// Whether all axes have come to rest, and have stood for two ticks (s): only then do the first and second differences
    /// of their positions tell so, which is what the next set-points are held against.
    pub(super) fn is_over(&self, tick: f64) -> bool {
        let stood = self.time - 2.0 * tick;
        self.axes.iter().all(|stop| stood >= stop.duration())
    }
}

/// Braking along a line: every axis follows the same course, scaled by its velocity.
#[derive(Clone, Copy)]
struct Line {
    /// Acceleration per velocity at first, 1/s.
    gain: f64,
    /// Acceleration per velocity that every axis can bear, 1/s.
    acceleration: f64,
    /// Jerk per velocity that every axis can bear, 1/s².
    jerk: f64,
}

impl Line {
    fn stop_of(&self, state: &State) -> Option<Stop> {
        let speed = state.velocity.abs();
        if speed == 0.0 {
            return Some(Stop::default());
        }
        let start = Motion {
            velocity: state.velocity,
            acceleration: self.gain * state.velocity,
        };
        Stop::new(start, self.acceleration * speed, self.jerk * speed)
    }
}

/// The line on which the axes move, if their accelerations are proportional to their velocities.
fn line<'a>(axes: impl Iterator<Item = (State, &'a AxisLimits)> + Clone) -> Option<Line> {
    let by_speed = |state: &State| state.velocity.abs();
    let states = axes.clone().map(|(state, _)| state);
    let fastest = states.max_by(|one, other| by_speed(one).total_cmp(&by_speed(other)))?;
    let gain = if fastest.velocity == 0.0 {
        0.0
    } else {
        fastest.acceleration / fastest.velocity
    };
    let mut line = Line {
        gain,
        acceleration: f64::INFINITY,
        jerk: f64::INFINITY,
    };
    for (state, limits) in axes {
        let off = state.acceleration - gain * state.velocity;
        if off.abs() > STRAIGHT * limits.acceleration {
            return None;
        }
        line.acceleration = line
            .acceleration
            .min(limits.acceleration / by_speed(&state));
        line.jerk = line.jerk.min(limits.jerk / by_speed(&state));
    }
    Some(line)
}

fn motion(state: &State) -> Motion {
    Motion {
        velocity: state.velocity,
        acceleration: state.acceleration,
    }
}
