//! Time law of the path parameter: the piece in force and the brake behind it.

use rpi_kin::state_to_rest::{AxisState, StateToRestProfile};
use rpi_kin::stop_profile::{JerkPhase, StopProfile, VelocityState};

/// Duration for which a plan is followed before its stop begins, s. It is planned anew every [`REPLAN_PERIOD`]; the
/// rest is a reserve, so that a plan that fails does not slow the motion at once.
pub const PIECE: f64 = 16e-3;

/// Time between two plans, s.
pub const REPLAN_PERIOD: f64 = 4e-3;

/// State of the path parameter: position along the path with first and second derivative by time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathState {
    /// Path parameter, m (rad on a joint line).
    pub s: f64,
    /// Velocity of the path parameter.
    pub velocity: f64,
    /// Second derivative of the path parameter by time.
    pub acceleration: f64,
}

impl PathState {
    /// Returns the state `time` seconds later under a constant `jerk`.
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

/// Time law that ends at rest on the path: up to [`PIECE`] seconds of a plan, then a stop. It can be followed to its
/// end if no further plan succeeds.
#[derive(Clone, Copy, Debug)]
pub struct HeldBrake {
    /// Time of the motion at which it starts, s.
    pub start_time: f64,
    /// Position, speed and acceleration along the path at `start_time`.
    pub start: PathState,
    /// Plan that is followed first; `None` if the stop begins at once.
    pub piece: Option<StateToRestProfile>,
    /// Duration for which the plan is followed, s; 0 without one.
    pub piece_time: f64,
    /// State of the path parameter where the stop begins.
    pub turn: PathState,
    /// Stop at the end of the time law.
    pub stop: StopProfile,
}

impl HeldBrake {
    /// Creates the law that stands at the place `s`.
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
        }
    }

    /// Creates the law that stops at once, with maximum magnitudes of acceleration and jerk. `None` if a number is not
    /// finite.
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
        })
    }

    /// Creates the law that follows `plan` for [`PIECE`] seconds, and at least to the place `behind`, and then stops with
    /// maximum magnitudes of acceleration and jerk. `None` if the plan goes backwards there, or a number is not finite.
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

    /// As [`HeldBrake::following`], but the plan is followed for `piece_time` seconds.
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
        })
    }

    /// Returns the stop behind the plan, as a law of its own; `None` if the plan goes backwards in between.
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

    /// Returns the state at a time of the motion, s; after the end, the state at rest.
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

    /// Returns the path parameter at rest.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.turn.s + self.stop.distance()
    }

    /// Returns the phases of constant jerk of the whole law, in order: those of the piece, cut to its duration, then
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

/// Time at which a plan that does not go backwards comes to a place, s; its duration if the place is its end or beyond.
fn time_at(plan: &StateToRestProfile, place: f64) -> f64 {
    /// Halvings of the interval: the time need not be exact.
    const STEPS: u32 = 20;
    if plan.start().position >= place {
        return 0.0;
    }
    let (mut early, mut late) = (0.0, plan.duration());
    for _ in 0..STEPS {
        let middle = f64::midpoint(early, late);
        match plan.state_at(middle).position < place {
            true => early = middle,
            false => late = middle,
        }
    }
    late
}

fn stop_from(state: &PathState, acceleration: f64, jerk: f64) -> Option<StopProfile> {
    let from = VelocityState {
        velocity: state.velocity,
        acceleration: state.acceleration,
    };
    StopProfile::new(from, acceleration, jerk)
}
