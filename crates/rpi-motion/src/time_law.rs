//! Time law of the path parameter: the piece in force and the brake behind it.

use crate::passage::bisect;
use rpi_kin::state_to_rest::{AxisState, StateToRestProfile};
use rpi_kin::stop_profile::{JerkPhase, StopProfile, VelocityState};

/// Time for which a plan is followed before its stop begins, s. A new plan is made every [`REPLAN_PERIOD`]; the rest is
/// a reserve, so that a plan that fails does not slow the motion at once.
pub const PIECE: f64 = 16e-3;

/// Time between two plans, s.
pub const REPLAN_PERIOD: f64 = 4e-3;

/// State of a motion along a path: position along the path, with its first and second derivatives with respect to time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathState {
    /// Position along the path (path parameter), m (rad on a joint line).
    pub s: f64,
    /// Velocity along the path, m/s; rad/s on a line in joint space.
    pub velocity: f64,
    /// Acceleration along the path, m/s²; rad/s² on a line in joint space.
    pub acceleration: f64,
}

impl PathState {
    /// Returns the state `time` seconds later under a constant `jerk` along the path.
    #[must_use]
    pub fn advanced(self, time: f64, jerk: f64) -> Self {
        AxisState::from(self).advanced(time, jerk).into()
    }
}

impl From<AxisState> for PathState {
    fn from(state: AxisState) -> Self {
        Self {
            s: state.position,
            velocity: state.velocity,
            acceleration: state.acceleration,
        }
    }
}

impl From<PathState> for AxisState {
    fn from(state: PathState) -> Self {
        Self {
            position: state.s,
            velocity: state.velocity,
            acceleration: state.acceleration,
        }
    }
}

/// Time law along a path that ends at rest: some time of a plan (usually [`PIECE`] seconds), then a stop. The motion
/// can follow it to its end if no further plan succeeds.
#[derive(Clone, Copy, Debug)]
pub struct HeldBrake {
    /// Time since the start of the motion at which this time law begins, s.
    pub start_time: f64,
    /// Position, velocity and acceleration along the path at `start_time`.
    pub start: PathState,
    /// Plan that the motion follows first; `None` if the stop begins at once.
    pub piece: Option<StateToRestProfile>,
    /// Time for which the plan is followed, s; 0 without a plan.
    pub piece_time: f64,
    /// State of the motion along the path where the stop begins.
    pub turn: PathState,
    /// Stop at the end of the time law.
    pub stop: StopProfile,
    /// Maximum magnitudes of acceleration (m/s²; rad/s² on a joint line) and jerk (m/s³; rad/s³) of the stop; 0 for a
    /// time law that rests.
    pub stop_bounds: (f64, f64),
}

impl HeldBrake {
    /// Creates the time law that rests at the position `s` along the path from the time `start_time` of the motion (s)
    /// on.
    #[must_use]
    pub fn standing(s: f64, start_time: f64) -> Self {
        let at = PathState {
            s,
            ..PathState::default()
        };
        Self {
            start_time,
            start: at,
            piece: None,
            piece_time: 0.0,
            turn: at,
            stop: StopProfile::default(),
            stop_bounds: (0.0, 0.0),
        }
    }

    /// Creates the time law that stops at once from the state `from`, with these maximum magnitudes of acceleration and
    /// jerk along the path. `None` if a number is not finite.
    #[must_use]
    pub fn stopping(
        from: PathState,
        start_time: f64,
        acceleration: f64,
        jerk: f64,
    ) -> Option<Self> {
        let stop = stop_from(&from, acceleration, jerk)?;
        Some(Self {
            start_time,
            start: from,
            piece: None,
            piece_time: 0.0,
            turn: from,
            stop,
            stop_bounds: (acceleration, jerk),
        })
    }

    /// Creates the time law that follows `plan` for [`PIECE`] seconds, and at least to the position `behind` along the
    /// path, and then stops with the acceleration and jerk in `brake`. `None` if the plan moves backwards there, or a
    /// number is not finite.
    #[must_use]
    pub fn following(
        plan: StateToRestProfile,
        start_time: f64,
        behind: f64,
        brake: (f64, f64),
    ) -> Option<Self> {
        let piece_time = PIECE.max(time_at(&plan, behind));
        Self::lasting(plan, start_time, piece_time, brake)
    }

    /// Creates the time law that follows `plan` for `piece_time` seconds and then stops with these maximum magnitudes
    /// of acceleration and jerk. `None` if the plan moves backwards there, or a number is not finite.
    #[must_use]
    pub fn lasting(
        plan: StateToRestProfile,
        start_time: f64,
        piece_time: f64,
        (acceleration, jerk): (f64, f64),
    ) -> Option<Self> {
        let turn = PathState::from(plan.state_at(piece_time));
        if turn.velocity < -1e-9 {
            return None;
        }
        Some(Self {
            start_time,
            start: plan.start().into(),
            piece: Some(plan),
            piece_time,
            turn,
            stop: stop_from(&turn, acceleration, jerk)?,
            stop_bounds: (acceleration, jerk),
        })
    }

    /// Returns the stop after the plan as a time law of its own; `None` if the plan leads backwards.
    #[must_use]
    pub fn behind_piece(&self) -> Option<Self> {
        (self.turn.s >= self.start.s).then_some(Self {
            start_time: self.start_time + self.piece_time,
            start: self.turn,
            piece: None,
            piece_time: 0.0,
            ..*self
        })
    }

    /// Returns the state along the path at a time of the motion (s); after the end, the state at rest.
    #[must_use]
    pub fn state_at(&self, time: f64) -> PathState {
        let elapsed = time - self.start_time;
        if let Some(plan) = &self.piece
            && elapsed < self.piece_time
        {
            return plan.state_at(elapsed).into();
        }
        let mut left = (elapsed - self.piece_time).max(0.0);
        let mut state = self.turn;
        for phase in self.stop.phases() {
            let spent = left.min(phase.duration);
            state = state.advanced(spent, phase.jerk);
            left -= spent;
        }
        if left > 0.0 {
            // Behind the end, rounding must not leave a velocity of 1e-19.
            state.velocity = 0.0;
            state.acceleration = 0.0;
        }
        state
    }

    /// Returns the position along the path at which the time law comes to rest.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.turn.s + self.stop.distance()
    }

    /// Returns the phases of constant jerk of the whole time law in order: those of the plan, cut to its time, then
    /// those of the stop.
    pub fn phases(&self) -> impl Iterator<Item = JerkPhase> + '_ {
        let mut left = self.piece_time;
        let piece = self.piece.map(|plan| plan.phases()).unwrap_or_default();
        let cut = piece.into_iter().map(move |phase| {
            let duration = phase.duration.min(left);
            left -= duration;
            JerkPhase { duration, ..phase }
        });
        cut.chain(self.stop.phases().iter().copied())
    }
}

/// Returns the time (s, since the start of the plan) at which a plan that does not move backwards reaches the position
/// `place` along the path; the duration of the plan if `place` is its end or beyond.
fn time_at(plan: &StateToRestProfile, place: f64) -> f64 {
    /// Number of times that the interval that contains the time is halved: the time need not be exact.
    const STEPS: u32 = 20;
    if plan.start().position >= place {
        return 0.0;
    }
    let position = |time: f64| plan.state_at(time).position;
    bisect(position, (0.0, plan.duration()), place, STEPS)
}

fn stop_from(state: &PathState, acceleration: f64, jerk: f64) -> Option<StopProfile> {
    let from = VelocityState {
        velocity: state.velocity,
        acceleration: state.acceleration,
    };
    StopProfile::new(from, acceleration, jerk)
}
