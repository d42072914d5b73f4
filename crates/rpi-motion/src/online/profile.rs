//! Motion of one axis as phases of constant jerk.

use rpi_kin::state_to_rest::AxisState;
use rpi_kin::stop_profile::JerkPhase;

/// Smallest and largest position of a motion, with the times at which they are reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PositionExtrema {
    /// Smallest position, rad or m.
    pub min: f64,
    /// Largest position, rad or m.
    pub max: f64,
    /// Time of the smallest position, s.
    pub time_of_min: f64,
    /// Time of the largest position, s.
    pub time_of_max: f64,
}

/// Planned motion of one axis, as phases of constant jerk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisProfile {
    start: AxisState,
    end: AxisState,
    phases: [JerkPhase; Self::MAX_PHASES],
    count: usize,
    duration: f64,
    /// Velocity, rad/s or m/s, by which the position is corrected over the whole motion, so that it ends exactly at the
    /// target despite rounding.
    drift: f64,
}

impl AxisProfile {
    /// Maximum number of phases: four of the return into the limits, and two superimposed motions of seven.
    pub const MAX_PHASES: usize = 18;

    /// Creates a profile without duration from `start` to `end`, to which phases are appended.
    pub(super) fn standing(start: AxisState, end: AxisState) -> Self {
        Self {
            start,
            end,
            phases: [JerkPhase::default(); Self::MAX_PHASES],
            count: 0,
            duration: 0.0,
            drift: 0.0,
        }
    }

    /// Appends a phase of `duration` seconds with constant `jerk`. A phase without duration is left out; a phase with
    /// the jerk of the last one prolongs the last one.
    pub(super) fn push(&mut self, duration: f64, jerk: f64) {
        if duration <= 0.0 {
            return;
        }
        if let Some(last) = self.phases[..self.count].last_mut()
            && last.jerk == jerk
        {
            last.duration += duration;
        } else if self.count < Self::MAX_PHASES {
            self.phases[self.count] = JerkPhase { duration, jerk };
            self.count += 1;
        }
    }

    /// Completes a motion to the position of its target. `duration` (s) may differ from the sum of the phases by
    /// rounding.
    pub(super) fn finished(mut self, duration: f64) -> Self {
        self.duration = duration;
        let missed = self.end.position - self.integrated().position;
        if duration > 0.0 {
            self.drift = missed / duration;
        }
        self
    }

    /// Completes a motion whose target has no position: the end gets the position that the axis reaches. `duration` (s)
    /// may differ from the sum of the phases by rounding.
    pub(super) fn released(mut self, duration: f64) -> Self {
        self.duration = duration;
        self.end.position = self.integrated().position;
        self
    }

    fn integrated(&self) -> AxisState {
        self.phases().iter().fold(self.start, advance)
    }

    /// Returns the phases of constant jerk in order, without those that have no duration.
    #[must_use]
    pub fn phases(&self) -> &[JerkPhase] {
        &self.phases[..self.count]
    }

    /// Returns the time from the start of the motion until the target is reached, s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Returns position, velocity and acceleration of the axis at time 0 of the profile.
    #[must_use]
    pub fn start(&self) -> AxisState {
        self.start
    }

    /// Returns the state of the axis at the end of the motion: the target.
    #[must_use]
    pub fn end(&self) -> AxisState {
        self.end
    }

    /// Returns the state of the axis `time` seconds after the start. A negative time gives the state at the start, the
    /// duration exactly the target. After the end, the axis continues with the acceleration of the target.
    #[must_use]
    pub fn state_at(&self, time: f64) -> AxisState {
        if time >= self.duration {
            return self.end.advanced(time - self.duration, 0.0);
        }
        let (mut left, mut state) = (time.max(0.0), self.start);
        for phase in self.phases() {
            let spent = left.min(phase.duration);
            state = state.advanced(spent, phase.jerk);
            left -= spent;
            if left <= 0.0 {
                break;
            }
        }
        state.position += self.drift * time.max(0.0);
        state
    }

    /// Returns the jerk (rad/s³ or m/s³) `time` seconds after the start; 0 before the start and after the end.
    #[must_use]
    pub fn jerk_at(&self, time: f64) -> f64 {
        let mut left = time;
        let current = self.phases().iter().find(|phase| {
            left -= phase.duration;
            left < 0.0
        });
        current
            .filter(|_| time >= 0.0)
            .map_or(0.0, |phase| phase.jerk)
    }

    /// Returns the smallest and largest position between start and end of the motion, with their times.
    #[must_use]
    pub fn position_extrema(&self) -> PositionExtrema {
        let mut extrema = PositionExtrema {
            min: self.start.position,
            max: self.start.position,
            ..PositionExtrema::default()
        };
        let (mut state, mut begin) = (self.start, 0.0);
        for phase in self.phases() {
            for time in turns(&state, phase) {
                // The comparison is false for NaN, which stands for no turn.
                if time > 0.0 && time < phase.duration {
                    extrema.add(state.advanced(time, phase.jerk).position, begin + time);
                }
            }
            state = advance(state, phase);
            begin += phase.duration;
            // A turn at the end of a phase may lie beyond it by rounding.
            extrema.add(state.position, begin);
        }
        extrema.add(self.end.position, self.duration);
        extrema
    }
}

impl PositionExtrema {
    fn add(&mut self, position: f64, time: f64) {
        if position < self.min {
            (self.min, self.time_of_min) = (position, time);
        }
        if position > self.max {
            (self.max, self.time_of_max) = (position, time);
        }
    }
}

fn advance(state: AxisState, phase: &JerkPhase) -> AxisState {
    state.advanced(phase.duration, phase.jerk)
}

/// Returns the times (s, from the start of the phase) at which the velocity is zero if the phase lasts for ever;
/// infinite or NaN if there is none. Uses the numerically stable form of the quadratic formula.
fn turns(state: &AxisState, phase: &JerkPhase) -> [f64; 2] {
    let (v, a, half) = (state.velocity, state.acceleration, phase.jerk / 2.0);
    let sum = -(a + libm::copysign(libm::sqrt(a * a - 4.0 * half * v), a)) / 2.0;
    [sum / half, v / sum]
}
