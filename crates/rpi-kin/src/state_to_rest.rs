//! Motion of one axis from any state to rest at a goal with bounded speed, acceleration and jerk.
//!
//! The motion is a change of speed to a peak, a time at that speed if the peak is the maximum speed, and a stop. Each
//! change is the fastest possible one. The peak is found numerically: the distance grows with the peak on each of the
//! three intervals of the search. From rest, this is the time-optimal double-S profile (Biagiotti and Melchiorri,
//! Trajectory Planning for Automatic Machines and Robots, 2008, 3.4). From motion, it is the fastest motion that has no
//! acceleration at its peak. A profile is planned once and sampled at any time in constant time.

use crate::stop_profile::{JerkPhase, StopProfile, VelocityState};

/// Position, velocity and acceleration of an axis, in rad and s (or m and s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisState {
    /// Position, rad or m.
    pub position: f64,
    /// Velocity, in rad/s or m/s.
    pub velocity: f64,
    /// Acceleration, in rad/s² or m/s².
    pub acceleration: f64,
}

/// Bounds of the velocity, acceleration and jerk of a motion, as magnitudes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Maximum velocity, in rad/s or m/s; positive.
    pub speed: f64,
    /// Maximum acceleration, in rad/s² or m/s²; positive.
    pub acceleration: f64,
    /// Maximum jerk, in rad/s³ or m/s³; positive.
    pub jerk: f64,
}

/// Planned motion of one axis to rest at a goal, with bounded velocity, acceleration and jerk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StateToRestProfile {
    start: AxisState,
    goal: f64,
    /// Velocity between the change of speed at the start and the stop at the end, rad/s or m/s.
    peak_velocity: f64,
    /// Time during which the axis moves with the peak velocity, in s.
    cruise_time: f64,
    /// Phases of constant jerk from the start to the peak velocity.
    accelerating: [JerkPhase; 3],
    /// Phases of constant jerk from the peak velocity to rest.
    stopping: [JerkPhase; 3],
}

/// Maximum number of iterations of the search for the peak velocity. Every fourth iteration halves the interval.
const STEPS: u32 = 100;

impl AxisState {
    /// Returns the state of an axis from its position and the first and second backward differences of its positions,
    /// `dt` seconds apart, assuming a constant `jerk`. Differences lag behind velocity and acceleration; the lag is
    /// corrected.
    fn from_differences(differences: Self, jerk: f64, dt: f64) -> Self {
        let acceleration = differences.acceleration + jerk * dt;
        Self {
            position: differences.position,
            velocity: differences.velocity + dt * (acceleration / 2.0 - jerk * dt / 6.0),
            acceleration,
        }
    }

    /// Returns the state `time` seconds later under a constant `jerk` (rad/s³ or m/s³).
    #[must_use]
    pub fn advanced(self, time: f64, jerk: f64) -> Self {
        let AxisState {
            position,
            velocity,
            acceleration,
        } = self;
        let travelled = time * (velocity + time * (acceleration / 2.0 + time * jerk / 6.0));
        AxisState {
            position: position + travelled,
            velocity: velocity + time * (acceleration + time * jerk / 2.0),
            acceleration: acceleration + time * jerk,
        }
    }

    fn mirrored(self) -> Self {
        AxisState {
            position: -self.position,
            velocity: -self.velocity,
            acceleration: -self.acceleration,
        }
    }
}

impl Bounds {
    /// Returns whether all bounds are positive and finite.
    #[must_use]
    pub fn are_positive(&self) -> bool {
        let usable = |bound: f64| bound > 0.0 && bound.is_finite();
        usable(self.speed) && usable(self.acceleration) && usable(self.jerk)
    }
}

impl StateToRestProfile {
    /// Plans the motion from `start` to rest at the position `goal` (rad or m). A start beyond the bounds is first
    /// brought back within them.
    ///
    /// Returns `None` if a bound is not positive or a number is not finite.
    #[must_use]
    pub fn new(start: AxisState, goal: f64, bounds: Bounds) -> Option<Self> {
        let numbers = [start.position, start.velocity, start.acceleration, goal];
        if !bounds.are_positive() || numbers.iter().any(|number| !number.is_finite()) {
            return None;
        }
        let coming =
            start.velocity + start.acceleration * start.acceleration.abs() / (2.0 * bounds.jerk);
        if coming >= 0.0 {
            return Search { start, bounds }.profile_to(goal, coming);
        }
        // The search assumes a positive velocity, so a negative one is solved as its mirror image.
        let mirror = Search {
            start: start.mirrored(),
            bounds,
        };
        Some(mirror.profile_to(-goal, -coming)?.mirrored())
    }

    /// Plans a motion to rest at the position `goal` that continues set-points `dt` seconds apart. `differences` is the
    /// last set-point with its first and second backward differences, as velocity and acceleration. The backward
    /// differences of the sampled set-points keep the bounds also across the transition. For this, the maximum speed is
    /// reduced by the change of speed that the jerk causes in two periods, which is the maximum error of the
    /// differences.
    ///
    /// Returns `None` under the same conditions as [`StateToRestProfile::new`].
    #[must_use]
    pub fn from_differences(
        differences: AxisState,
        dt: f64,
        goal: f64,
        bounds: Bounds,
    ) -> Option<Self> {
        let bounds = Bounds {
            // At least half of the speed remains, also for a period so long that the correction would exceed it.
            speed: (bounds.speed - 2.0 * bounds.jerk * dt * dt).max(bounds.speed / 2.0),
            ..bounds
        };
        let plan = |jerk: f64| {
            Self::new(
                AxisState::from_differences(differences, jerk, dt),
                goal,
                bounds,
            )
        };
        let steady = plan(0.0)?;
        // The motion starts with this jerk. If the jerk is assumed for the previous period as well, no period is lost.
        let jerk = steady.jerk_at(dt / 2.0);
        let at_once = plan(jerk)?;
        Some(if at_once.jerk_at(dt / 2.0) == jerk {
            at_once
        } else {
            steady
        })
    }

    /// Returns the jerk (rad/s³ or m/s³) `time` seconds after the start of the motion; 0 after its end.
    #[must_use]
    pub fn jerk_at(&self, time: f64) -> f64 {
        let mut left = time;
        let phases = self.phases();
        let now = phases.iter().find(|part| {
            left -= part.duration;
            left < 0.0
        });
        now.map_or(0.0, |part| part.jerk)
    }

    /// Returns the phases of constant jerk in order: three from the start to the peak velocity, one at the peak
    /// velocity, three to rest. Unused ones have the duration 0.
    #[must_use]
    pub fn phases(&self) -> [JerkPhase; 7] {
        let [a, b, c] = self.accelerating;
        let [d, e, f] = self.stopping;
        let cruise = JerkPhase {
            duration: self.cruise_time,
            jerk: 0.0,
        };
        [a, b, c, cruise, d, e, f]
    }

    /// Returns the state of the axis at the start of the motion.
    #[must_use]
    pub fn start(&self) -> AxisState {
        self.start
    }

    fn mirrored(self) -> Self {
        Self {
            start: self.start.mirrored(),
            goal: -self.goal,
            peak_velocity: -self.peak_velocity,
            cruise_time: self.cruise_time,
            accelerating: self.accelerating.map(JerkPhase::mirrored),
            stopping: self.stopping.map(JerkPhase::mirrored),
        }
    }

    /// Returns the duration of the motion in s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        duration(&self.accelerating) + self.cruise_time + duration(&self.stopping)
    }

    /// Returns the position at the end of the motion, in rad (or m).
    #[must_use]
    pub fn goal(&self) -> f64 {
        self.goal
    }

    /// Returns the state of the axis `time` seconds after the start of the motion. After the end, the axis is at rest
    /// at the goal.
    ///
    /// After the first change of speed, positions are computed backwards from the goal, so that rounding errors do not
    /// accumulate on a long motion.
    #[must_use]
    pub fn state_at(&self, time: f64) -> AxisState {
        if time >= self.duration() {
            return AxisState {
                position: self.goal,
                ..AxisState::default()
            };
        }
        let to_peak = duration(&self.accelerating);
        if time < to_peak {
            return advance(self.start, &self.accelerating, time.max(0.0));
        }
        let stopping = duration(&self.stopping);
        let after_peak = time - to_peak - self.cruise_time;
        // A change between two velocities with zero acceleration at both ends has their mean as its mean velocity.
        let braking = AxisState {
            position: self.goal - self.peak_velocity * stopping / 2.0
                + self.peak_velocity * after_peak.min(0.0),
            velocity: self.peak_velocity,
            acceleration: 0.0,
        };
        advance(braking, &self.stopping, after_peak.max(0.0))
    }

    /// Returns the profile as an array of numbers, for storage in the state of a primitive (a basic operation of a
    /// net).
    #[must_use]
    pub fn to_array(&self) -> [f64; Self::LEN] {
        let mut numbers = [0.0; Self::LEN];
        let AxisState {
            position,
            velocity,
            acceleration,
        } = self.start;
        let (head, parts) = numbers.split_at_mut(HEAD);
        head.copy_from_slice(&[
            position,
            velocity,
            acceleration,
            self.goal,
            self.peak_velocity,
            self.cruise_time,
        ]);
        for (slot, part) in parts
            .chunks_exact_mut(2)
            .zip(self.accelerating.iter().chain(&self.stopping))
        {
            slot.copy_from_slice(&[part.duration, part.jerk]);
        }
        numbers
    }

    /// Creates a profile from the numbers of [`StateToRestProfile::to_array`].
    #[must_use]
    pub fn from_array(numbers: &[f64; Self::LEN]) -> Self {
        let [
            position,
            velocity,
            acceleration,
            goal,
            peak,
            cruise,
            rest @ ..,
        ] = *numbers;
        let part = |k: usize| JerkPhase {
            duration: rest[2 * k],
            jerk: rest[2 * k + 1],
        };
        Self {
            start: AxisState {
                position,
                velocity,
                acceleration,
            },
            goal,
            peak_velocity: peak,
            cruise_time: cruise,
            accelerating: [part(0), part(1), part(2)],
            stopping: [part(3), part(4), part(5)],
        }
    }

    /// Number of reals in the array that stores a profile.
    pub const LEN: usize = HEAD + 12;
}

const HEAD: usize = 6;

fn duration(parts: &[JerkPhase; 3]) -> f64 {
    parts.iter().map(|part| part.duration).sum()
}

fn advance(start: AxisState, parts: &[JerkPhase; 3], time: f64) -> AxisState {
    let (mut left, mut state) = (time, start);
    for part in parts {
        let spent = left.min(part.duration);
        state = state.advanced(spent, part.jerk);
        left -= spent;
    }
    state
}

/// Search for the peak velocity of a motion whose velocity is positive once the acceleration of the start has decayed.
#[derive(Clone, Copy)]
struct Search {
    start: AxisState,
    bounds: Bounds,
}

impl Search {
    /// Returns the motion to the position `goal` (rad or m); `None` if a number is not finite. `coming` is the velocity
    /// that remains once the acceleration of the start has decayed.
    fn profile_to(&self, goal: f64, coming: f64) -> Option<StateToRestProfile> {
        let (peak, cruise) = self.peak_and_cruise(goal - self.start.position, coming)?;
        let (first, last) = self.speed_changes(peak)?;
        Some(StateToRestProfile {
            start: self.start,
            goal,
            peak_velocity: peak,
            cruise_time: cruise,
            accelerating: first.phases,
            stopping: last.phases,
        })
    }

    fn peak_and_cruise(&self, distance: f64, coming: f64) -> Option<(f64, f64)> {
        let fastest = self.bounds.speed;
        let coming = coming.min(fastest);
        let beyond = distance - self.distance(fastest)?;
        if beyond >= 0.0 {
            return Some((fastest, beyond / fastest));
        }
        let behind = self.distance(-fastest)? - distance;
        if behind >= 0.0 {
            return Some((-fastest, behind / fastest));
        }
        let (low, high) = if distance >= self.distance(coming)? {
            (coming, fastest)
        } else if distance >= self.distance(0.0)? {
            (0.0, coming)
        } else {
            (-fastest, 0.0)
        };
        Some((self.peak(distance, low, high)?, 0.0))
    }

    /// Returns the change of velocity from the start to the peak velocity `peak`, and the stop from there; `None` if a
    /// number is not finite.
    fn speed_changes(&self, peak: f64) -> Option<(StopProfile, StopProfile)> {
        let to = |motion: VelocityState| {
            StopProfile::new(motion, self.bounds.acceleration, self.bounds.jerk)
        };
        let first = to(VelocityState {
            velocity: self.start.velocity - peak,
            acceleration: self.start.acceleration,
        })?;
        let last = to(VelocityState {
            velocity: peak,
            acceleration: 0.0,
        })?;
        Some((first, last))
    }

    /// Returns the signed distance (rad or m) if the axis reaches the velocity `peak` and stops from it at once; `None`
    /// if a number is not finite.
    fn distance(&self, peak: f64) -> Option<f64> {
        let (first, last) = self.speed_changes(peak)?;
        Some(first.distance() + peak * first.duration() + last.distance())
    }

    /// Returns the peak velocity between `low` and `high` for which the motion covers the signed `distance` (rad or m);
    /// `None` if a number is not finite. Uses regula falsi with the Illinois modification (halved weight of a retained
    /// end), and a bisection in every fourth step to guarantee convergence.
    fn peak(&self, distance: f64, mut low: f64, mut high: f64) -> Option<f64> {
        let off = |peak: f64| Some(self.distance(peak)? - distance);
        let (mut below, mut above) = (off(low)?, off(high)?);
        for step in 0..STEPS {
            if below == 0.0 || above == 0.0 || high - low <= f64::EPSILON * (low.abs() + high.abs())
            {
                break;
            }
            let share = if step % 4 == 3 {
                0.5
            } else {
                below / (below - above)
            };
            let middle = low + share * (high - low);
            let at = off(middle)?;
            if at <= 0.0 {
                (low, below, above) = (middle, at, above / 2.0);
            } else {
                (high, above, below) = (middle, at, below / 2.0);
            }
        }
        // The search may end at two neighbouring numbers, of which neither is exact.
        let low_is_nearer = off(low)?.abs() <= off(high)?.abs();
        Some(if low_is_nearer { low } else { high })
    }
}
