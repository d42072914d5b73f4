//! Bringing one axis from any state of motion to rest at a goal, within its speed, acceleration and jerk.
//!
//! The way is a change of speed to a peak, a time at that speed if the peak is the greatest one, and a stop; each change is the
//! fastest there is. The peak is found numerically: the distance grows with it on each of the three stretches on which
//! it is looked for. From rest this is the time-optimal double-S profile (Biagiotti and Melchiorri, Trajectory Planning
//! for Automatic Machines and Robots, 2008, 3.4); from motion it is the fastest way that passes its peak without acceleration.
//! Built once, then sampled at any time in constant time.

use crate::stop::{Motion, Part, Stop};

/// Position, velocity and acceleration of an axis: rad and s, or m and s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Position.
    pub position: f64,
    /// Velocity.
    pub velocity: f64,
    /// Acceleration.
    pub acceleration: f64,
}

/// The magnitudes that may be used, all positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Of the velocity.
    pub speed: f64,
    /// Of the acceleration.
    pub acceleration: f64,
    /// Of the jerk.
    pub jerk: f64,
}

/// A planned way to rest at a goal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reach {
    start: State,
    goal: f64,
    /// The velocity between the changes.
    peak: f64,
    /// Seconds at the peak.
    cruise: f64,
    /// From the start to the peak.
    first: [Part; 3],
    /// From the peak to rest.
    last: [Part; 3],
}

/// Steps of the search for the peak at most; each that finds no better bound halves the stretch.
const STEPS: u32 = 100;

impl State {
    /// The state behind a position and its first and second backward differences over `dt`, if the jerk was `jerk` all the
    /// while: differences lag behind velocity and acceleration.
    fn behind(differences: Self, jerk: f64, dt: f64) -> Self {
        let acceleration = differences.acceleration + jerk * dt;
        Self {
            position: differences.position,
            velocity: differences.velocity + dt * (acceleration / 2.0 - jerk * dt / 6.0),
            acceleration,
        }
    }

    fn after(self, time: f64, jerk: f64) -> Self {
        let State {
            position,
            velocity,
            acceleration,
        } = self;
        let travelled = time * (velocity + time * (acceleration / 2.0 + time * jerk / 6.0));
        State {
            position: position + travelled,
            velocity: velocity + time * (acceleration + time * jerk / 2.0),
            acceleration: acceleration + time * jerk,
        }
    }

    fn mirrored(self) -> Self {
        State {
            position: -self.position,
            velocity: -self.velocity,
            acceleration: -self.acceleration,
        }
    }
}

impl Bounds {
    /// Whether all are positive and finite.
    #[must_use]
    pub fn are_usable(&self) -> bool {
        let usable = |bound: f64| bound > 0.0 && bound.is_finite();
        usable(self.speed) && usable(self.acceleration) && usable(self.jerk)
    }
}

impl Reach {
    /// Plans the way from `start` to rest at `goal`. A start beyond the bounds is brought back within them first.
    ///
    /// `None` if a bound is not positive or a number is not finite.
    #[must_use]
    pub fn new(start: State, goal: f64, bounds: Bounds) -> Option<Self> {
        let numbers = [start.position, start.velocity, start.acceleration, goal];
        if !bounds.are_usable() || numbers.iter().any(|number| !number.is_finite()) {
            return None;
        }
        let coming =
            start.velocity + start.acceleration * start.acceleration.abs() / (2.0 * bounds.jerk);
        if coming >= 0.0 {
            return Search { start, bounds }.way(goal, coming);
        }
        let mirror = Search {
            start: start.mirrored(),
            bounds,
        };
        Some(mirror.way(-goal, -coming)?.mirrored())
    }

    /// Plans the way on from set-points `dt` apart, of which the last one and its first and second backward differences are
    /// known: set-points sampled from it keep the bounds in their backward differences over the joint, too. The speed that
    /// is planned with is lower by what the jerk can change in two periods, which is as far as the differences may be off.
    ///
    /// `None` as for [`Reach::new`].
    #[must_use]
    pub fn following(differences: State, dt: f64, goal: f64, bounds: Bounds) -> Option<Self> {
        let bounds = Bounds {
            speed: (bounds.speed - 2.0 * bounds.jerk * dt * dt).max(bounds.speed / 2.0),
            ..bounds
        };
        let plan = |jerk: f64| Self::new(State::behind(differences, jerk, dt), goal, bounds);
        let steady = plan(0.0)?;
        // The way on begins with this jerk: then it may as well have been there before, and no period is lost.
        let jerk = steady.jerk_at(dt / 2.0);
        let at_once = plan(jerk)?;
        Some(if at_once.jerk_at(dt / 2.0) == jerk {
            at_once
        } else {
            steady
        })
    }

    fn jerk_at(&self, time: f64) -> f64 {
        let mut left = time;
        let cruise = Part {
            duration: self.cruise,
            jerk: 0.0,
        };
        let mut parts = self.first.iter().chain([&cruise]).chain(&self.last);
        let now = parts.find(|part| {
            left -= part.duration;
            left < 0.0
        });
        now.map_or(0.0, |part| part.jerk)
    }

    fn mirrored(self) -> Self {
        Self {
            start: self.start.mirrored(),
            goal: -self.goal,
            peak: -self.peak,
            cruise: self.cruise,
            first: self.first.map(Part::mirrored),
            last: self.last.map(Part::mirrored),
        }
    }

    /// How long it takes, in s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        duration(&self.first) + self.cruise + duration(&self.last)
    }

    /// Where it ends.
    #[must_use]
    pub fn goal(&self) -> f64 {
        self.goal
    }

    /// The state `time` seconds after the start; at rest at the goal from the end on.
    ///
    /// What follows the first change is reckoned from the goal back, so that no rounding adds up on a long way.
    #[must_use]
    pub fn at(&self, time: f64) -> State {
        if time >= self.duration() {
            return State {
                position: self.goal,
                ..State::default()
            };
        }
        let to_peak = duration(&self.first);
        if time < to_peak {
            return along(self.start, &self.first, time.max(0.0));
        }
        let stopping = duration(&self.last);
        let after_peak = time - to_peak - self.cruise;
        // A change between two velocities without acceleration at its ends has their mean.
        let braking = State {
            position: self.goal - self.peak * stopping / 2.0 + self.peak * after_peak.min(0.0),
            velocity: self.peak,
            acceleration: 0.0,
        };
        along(braking, &self.last, after_peak.max(0.0))
    }

    /// All of it in numbers, for who keeps it from cycle to cycle.
    #[must_use]
    pub fn to_numbers(&self) -> [f64; Self::NUMBERS] {
        let mut numbers = [0.0; Self::NUMBERS];
        let State {
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
            self.peak,
            self.cruise,
        ]);
        for (slot, part) in parts
            .chunks_exact_mut(2)
            .zip(self.first.iter().chain(&self.last))
        {
            slot.copy_from_slice(&[part.duration, part.jerk]);
        }
        numbers
    }

    /// The way behind its numbers.
    #[must_use]
    pub fn from_numbers(numbers: &[f64; Self::NUMBERS]) -> Self {
        let [
            position,
            velocity,
            acceleration,
            goal,
            peak,
            cruise,
            rest @ ..,
        ] = *numbers;
        let part = |k: usize| Part {
            duration: rest[2 * k],
            jerk: rest[2 * k + 1],
        };
        Self {
            start: State {
                position,
                velocity,
                acceleration,
            },
            goal,
            peak,
            cruise,
            first: [part(0), part(1), part(2)],
            last: [part(3), part(4), part(5)],
        }
    }

    /// How many numbers there are.
    pub const NUMBERS: usize = HEAD + 12;
}

const HEAD: usize = 6;

fn duration(parts: &[Part; 3]) -> f64 {
    parts.iter().map(|part| part.duration).sum()
}

fn along(start: State, parts: &[Part; 3], time: f64) -> State {
    let (mut left, mut state) = (time, start);
    for part in parts {
        let spent = left.min(part.duration);
        state = state.after(spent, part.jerk);
        left -= spent;
    }
    state
}

/// What the peak is looked for with: the start comes with a positive velocity.
#[derive(Clone, Copy)]
struct Search {
    start: State,
    bounds: Bounds,
}

impl Search {
    /// The way to `goal`; `coming` is the velocity once the acceleration at the start has run out.
    fn way(&self, goal: f64, coming: f64) -> Option<Reach> {
        let (peak, cruise) = self.peak_and_cruise(goal - self.start.position, coming)?;
        let (first, last) = self.changes(peak)?;
        Some(Reach {
            start: self.start,
            goal,
            peak,
            cruise,
            first: first.parts,
            last: last.parts,
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

    /// The change of speed to a peak, and the stop from it.
    fn changes(&self, peak: f64) -> Option<(Stop, Stop)> {
        let to = |motion: Motion| Stop::new(motion, self.bounds.acceleration, self.bounds.jerk);
        let first = to(Motion {
            velocity: self.start.velocity - peak,
            acceleration: self.start.acceleration,
        })?;
        let last = to(Motion {
            velocity: peak,
            acceleration: 0.0,
        })?;
        Some((first, last))
    }

    /// How far it goes with a peak and no time at it.
    fn distance(&self, peak: f64) -> Option<f64> {
        let (first, last) = self.changes(peak)?;
        Some(first.distance() + peak * first.duration() + last.distance())
    }

    /// The peak between `low` and `high` with which it goes `distance`: regula falsi, with the weight of an end that
    /// stays halved (Illinois), and a halving now and then so that the stretch shrinks in any case.
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
        let low_is_nearer = off(low)?.abs() <= off(high)?.abs();
        Some(if low_is_nearer { low } else { high })
    }
}
