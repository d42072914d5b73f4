//! Motion of one axis to a target in a given duration.
//!
//! If possible, the axis cruises at a velocity between those of the two extremal motions. The travel grows with this
//! velocity, so it is found by a bracketed search. Otherwise the motion is the weighted mean of the two extremal motions
//! of this duration: all limits are convex, so the mean keeps them. It always exists where a motion exists.

use super::family::{Ends, Family, Times};
use super::root::root;
use super::velocity::VelocityChange;

/// Motion of one axis with a given duration, as a cruise between two changes of velocity or as a mean of two motions.
/// All quantities are divided by the maximum jerk.
#[derive(Clone, Copy, Debug)]
pub(super) enum TimedMotion {
    /// The axis changes to a cruise velocity, cruises, and changes to the velocity at the end.
    Cruising {
        /// Change from the velocity at the start to the cruise velocity.
        first: VelocityChange,
        /// Time at the cruise velocity, s; not negative.
        cruise: f64,
        /// Change from the cruise velocity to the velocity at the end.
        last: VelocityChange,
    },
    /// Weighted mean of the two extremal motions of this duration: the farthest and the nearest one.
    Mean {
        /// Durations of the phases of the motion with the longest travel.
        farthest: Times,
        /// Durations of the phases of the motion with the shortest travel.
        nearest: Times,
        /// Weight of `farthest` in the mean, from 0 (only `nearest`) to 1 (only `farthest`).
        weight: f64,
    },
}

impl TimedMotion {
    /// Plans a motion over `distance` in exactly `duration` (s). Returns `None` if no motion has this duration and
    /// misses the distance by at most `tolerance`.
    pub(super) fn new(ends: &Ends, distance: f64, duration: f64, tolerance: f64) -> Option<Self> {
        if duration < 0.0 {
            return None;
        }
        let up = Family::new(ends);
        let down = Family::new(&ends.mirrored());
        let (far, near) = (up.with_duration(duration)?, down.with_duration(duration)?);
        let (longest, shortest) = (up.position(far), -down.position(near));
        if distance > longest + tolerance || distance < shortest - tolerance {
            return None;
        }
        let cruise = Cruise {
            ends,
            distance,
            duration,
        };
        if let (Some(high), Some(low)) = (up.peak_velocity(far), down.peak_velocity(near))
            && let Some(cruising) = cruise.search(-low, high)
        {
            return Some(cruising);
        }
        let span = longest - shortest;
        let share = (distance - shortest) / span;
        Some(Self::Mean {
            farthest: up.times(far),
            nearest: down.times(near),
            weight: if span > 0.0 {
                share.clamp(0.0, 1.0)
            } else {
                0.5
            },
        })
    }

    /// Calls `visit` for each phase in order, with its duration (s) and its jerk as a share of the maximum jerk.
    pub(super) fn each_phase(&self, mut visit: impl FnMut(f64, f64)) {
        match self {
            Self::Cruising {
                first,
                cruise,
                last,
            } => {
                first.phases().for_each(|(time, jerk)| visit(time, jerk));
                visit(*cruise, 0.0);
                last.phases().for_each(|(time, jerk)| visit(time, jerk));
            }
            Self::Mean {
                farthest,
                nearest,
                weight,
            } => merge(farthest, nearest, *weight, visit),
        }
    }
}

/// Calls `visit` for each phase of the weighted mean of two motions, with its duration and jerk. The jerks of `nearest`
/// have the opposite signs of those of `farthest`; `weight` (0 to 1) is the weight of `farthest`.
fn merge(farthest: &Times, nearest: &Times, weight: f64, mut visit: impl FnMut(f64, f64)) {
    let mut left = [*farthest, *nearest];
    let mut at = [0, 0];
    // Each step ends a phase of one of both.
    for _ in 0..2 * farthest.len() {
        for (times, index) in left.iter().zip(&mut at) {
            while *index < times.len() && times[*index] <= 0.0 {
                *index += 1;
            }
        }
        let [i, j] = at;
        let (Some(a), Some(b)) = (left[0].get(i), left[1].get(j)) else {
            break;
        };
        let time = a.min(*b);
        let jerk = weight * super::axis::SIGNS[i] - (1.0 - weight) * super::axis::SIGNS[j];
        visit(time, jerk);
        left[0][i] -= time;
        left[1][j] -= time;
    }
}

/// Search for the cruise velocity with which a motion between `ends` covers `distance` in `duration`.
struct Cruise<'a> {
    ends: &'a Ends,
    distance: f64,
    duration: f64,
}

impl Cruise<'_> {
    fn changes(&self, velocity: f64) -> (VelocityChange, f64, VelocityChange) {
        let ends = self.ends;
        let first = VelocityChange::new(
            (ends.start_velocity, ends.start_acceleration),
            (velocity, 0.0),
            (ends.max_acceleration, ends.min_acceleration),
        );
        let last = VelocityChange::new(
            (velocity, 0.0),
            (ends.end_velocity, ends.end_acceleration),
            (ends.max_acceleration, ends.min_acceleration),
        );
        let cruise = self.duration - first.duration() - last.duration();
        (first, cruise, last)
    }

    /// Returns by how much the travel with a cruise at `velocity` exceeds the distance, and the derivative of the
    /// travel with respect to the velocity: the cruise time, plus half the time of each ramp of the acceleration next
    /// to the cruise.
    fn beyond(&self, velocity: f64) -> (f64, f64) {
        let (first, cruise, last) = self.changes(velocity);
        let ends = self.ends;
        let travel = first.travel(ends.start_velocity, ends.start_acceleration)
            + velocity * cruise
            + last.travel(velocity, 0.0);
        let slope = cruise + (first.level().abs() + last.level().abs()) / 2.0;
        (travel - self.distance, slope)
    }

    /// Searches the cruise velocity between `low` and `high`. Returns `None` if no cruise of positive duration is
    /// found.
    fn search(&self, low: f64, high: f64) -> Option<TimedMotion> {
        let (below, above) = (self.beyond(low).0, self.beyond(high).0);
        if below > 0.0 || above < 0.0 || low > high {
            return None;
        }
        let velocity = root((low, below), (high, above), |velocity| {
            self.beyond(velocity)
        });
        let (first, cruise, last) = self.changes(velocity);
        (cruise >= 0.0).then_some(TimedMotion::Cruising {
            first,
            cruise,
            last,
        })
    }
}
