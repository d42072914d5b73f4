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

/// Planned motion of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisProfile {
    start: AxisState,
    end: AxisState,
    phases: [JerkPhase; Self::MAX_PHASES],
    count: usize,
    duration: f64,
    /// Drift of the position, which brings the last phase to the target: rounding, and what a motion may miss.
    drift: f64,
}

impl AxisProfile {
    /// Maximum number of phases: four of the return into the limits, and two superimposed motions of seven.
    pub const MAX_PHASES: usize = 18;

    /// Motion without duration.
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

    /// Appends a phase. One without duration is left out, and one with the jerk of the last phase prolongs it.
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

    /// Completes a motion to the position of its target. `duration` differs from the sum of the phases by rounding only.
    pub(super) fn finished(mut self, duration: f64) -> Self {
        self.duration = duration;
        let missed = self.end.position - self.integrated().position;
        if duration > 0.0 {
            self.drift = missed / duration;
        }
        self
    }

    /// Completes a motion without a goal for the position.
    pub(super) fn released(mut self, duration: f64) -> Self {
        self.duration = duration;
        self.end.position = self.integrated().position;
        self
    }

    fn integrated(&self) -> AxisState {
        self.phases().iter().fold(self.start, advance)
    }

    /// Phases of constant jerk in order, without those of no duration.
    #[must_use]
    pub fn phases(&self) -> &[JerkPhase] {
        &self.phases[..self.count]
    }

    /// Duration, s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Returns position, velocity and acceleration of the axis at time 0 of the profile.
    #[must_use]
    pub fn start(&self) -> AxisState {
        self.start
    }

    /// State at the end: the target.
    #[must_use]
    pub fn end(&self) -> AxisState {
        self.end
    }

    /// State `time` seconds after the start. Before the start it is that at the start, and at the end exactly the
    /// target. After the end the axis goes on with the acceleration of the target.
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

    /// Jerk `time` seconds after the start; 0 before the start and after the end.
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

    /// Smallest and largest position from the start to the end.
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

/// Times at which the velocity of a phase is zero; infinite or NaN where there is none. The stable form of the quadratic
/// formula.
fn turns(state: &AxisState, phase: &JerkPhase) -> [f64; 2] {
    let (v, a, half) = (state.velocity, state.acceleration, phase.jerk / 2.0);
    let sum = -(a + libm::copysign(libm::sqrt(a * a - 4.0 * half * v), a)) / 2.0;
    [sum / half, v / sum]
}
