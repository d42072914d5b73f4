//! Motion of the axes towards goals that may change in every cycle: positions, moving positions, velocities.
//!
//! In every cycle the online generator plans from the state of the last set-point to the goal, and one period of this plan
//! is followed. Before that, the core looks ahead: a state is only taken if each axis could stop from it within its range.
//! Otherwise the axis takes a more careful plan, at last that of its stop. So the way to rest of the state before remains
//! possible at any time, and no goal, late or wrong, leads out of a range.
//!
//! Nothing allocates, and the work of a cycle is bounded: at most five plans of each axis.

mod exact;
mod outlook;

pub(crate) use self::exact::Share;
use self::outlook::states_on;
use crate::node::{USED_JERK_SHARE, USED_SHARE};
use crate::online::{AxisLimits, MotionOptions, OnlineMotion, Synchronization};
use crate::ranges::allowed_ranges;
use crate::{Arm, JointState, Joints, MotionError};
use rpi_kin::state_to_rest::{AxisState, Bounds};
use rpi_kin::{MAX_AXES, Range};

/// Goal of a motion of the axes, in rad and s (m and s for a linear axis).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointGoal {
    /// All axes come to rest at these positions (rad) at the same time: synchronised by time.
    Position(Joints),
    /// Each axis follows, as fast as it can, a goal that is at this position and moves with this velocity.
    Moving {
        /// Positions of the goal for all axes, rad.
        position: Joints,
        /// Velocities of the goal for all axes, rad/s.
        velocity: Joints,
    },
    /// The axes move with these velocities (rad/s), and stop before the ends of their ranges.
    Velocity(Joints),
    /// The axes come to rest, as fast as their limits allow, and stay there.
    Rest,
}

/// Set-point of a [`JointMotion`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSetPoint {
    /// Position, velocity and acceleration of the axes.
    pub state: JointState,
    /// True if the axes are at the goal: at its positions and with its velocities; for a velocity goal, with its
    /// velocities.
    pub at_goal: bool,
    /// First axis, counted from 0, that rests at the end of its range because the goal lies beyond; `None` if no axis
    /// does.
    pub at_range_end: Option<usize>,
}

/// Motion of the axes of one arm towards goals that may change in every cycle.
#[derive(Clone, Debug)]
pub struct JointMotion {
    arm: Arm,
    /// Period of the set-points, s.
    period: f64,
    /// Bounds of velocity, acceleration and jerk of each axis with which motions are planned: rad/s, rad/s², rad/s³.
    bounds: [Bounds; MAX_AXES],
    stops: [AxisLimits; MAX_AXES],
    ranges: [Range; MAX_AXES],
    /// State of each axis at the last set-point.
    state: [AxisState; MAX_AXES],
    /// State of each axis at the set-point before the last one.
    previous: [AxisState; MAX_AXES],
}

/// Difference of positions (rad) or velocities (rad/s) below which an axis counts as being at its goal.
const SAME: f64 = 1e-9;

/// Distance beyond the end of a range that counts as rounding, rad.
const OUTSIDE: f64 = 1e-9;

/// Maximum speed of a moving goal, as a share of the maximum speed of the axis: the axis must be able to catch up with
/// it.
const FASTEST_GOAL: f64 = 0.95;

/// State of axes that are at rest at position 0.
const AT_REST: [AxisState; MAX_AXES] = [AxisState {
    position: 0.0,
    velocity: 0.0,
    acceleration: 0.0,
}; MAX_AXES];

/// Arbitrary positive bounds for the entries beyond the axes of the arm.
const NO_AXIS: Bounds = Bounds {
    speed: 1.0,
    acceleration: 1.0,
    jerk: 1.0,
};

impl JointMotion {
    /// Creates the motion of an arm that is at rest at joint positions 0. `period` is the time between set-points, s.
    #[must_use]
    pub fn new(arm: Arm, period: f64) -> Self {
        let mut stops = [AxisLimits::from(NO_AXIS); MAX_AXES];
        for (slot, limits) in stops.iter_mut().zip(arm.limits()) {
            *slot = AxisLimits::from(Bounds {
                speed: limits.velocity,
                acceleration: limits.acceleration,
                jerk: limits.jerk,
            });
        }
        Self {
            ranges: allowed_ranges(&arm, &[0.0; MAX_AXES]),
            arm,
            period,
            bounds: [NO_AXIS; MAX_AXES],
            stops,
            state: AT_REST,
            previous: AT_REST,
        }
    }

    /// Begins a motion from `state`, the state of the arm as commanded. `period` is the time between set-points, s.
    /// `requested` are the bounds for each axis, in rad and s; they may be higher than its limits, which hold, too.
    ///
    /// # Errors
    /// [`MotionError::NotFinite`] if a number is not finite or a bound not positive. The present motion then continues.
    pub fn begin(
        &mut self,
        state: &JointState,
        requested: Bounds,
        period: f64,
    ) -> Result<(), MotionError> {
        if !(requested.are_positive() && state.is_finite()) {
            return Err(MotionError::NotFinite);
        }
        self.period = period;
        self.ranges = allowed_ranges(&self.arm, &state.position);
        for (axis, limits) in self.arm.limits().iter().enumerate() {
            // Leaves room for what the next motion does not know: see `can_stop_from`.
            let unknown = period * (limits.acceleration + limits.jerk * period);
            let speed = (limits.velocity - unknown).max(limits.velocity / 2.0);
            self.bounds[axis] = Bounds {
                speed: requested.speed.min(USED_SHARE * limits.velocity).min(speed),
                acceleration: requested.acceleration.min(USED_SHARE * limits.acceleration),
                jerk: requested.jerk.min(USED_JERK_SHARE * limits.jerk),
            };
        }
        // The entries beyond the axes of the arm stay at rest.
        let axes = self.arm.axes();
        self.state[..axes].copy_from_slice(&state.to_axes()[..axes]);
        self.previous = self.state;
        Ok(())
    }

    /// Returns the set-point of the next cycle: one period further towards the goal, with the share `speed_share` (0 to
    /// 1) of the requested speed. Call it once per period. A goal that is not finite counts as [`JointGoal::Rest`].
    pub fn next_set_point(&mut self, goal: &JointGoal, speed_share: f64) -> JointSetPoint {
        let goal = self.limited(goal, speed_share);
        let limits = self.limits(&goal, speed_share);
        let next = self.planned(&goal, &limits);
        self.previous = core::mem::replace(&mut self.state, next);
        JointSetPoint {
            state: JointState::from_axes(&next),
            at_goal: self.is_at(&goal),
            at_range_end: self.axis_at_end(&goal),
        }
    }

    /// Returns the state `elapsed` seconds after the last set-point if each axis stops on its own: for an arm that
    /// stops in steps shorter than a period. `elapsed` may be negative, down to minus one period.
    #[must_use]
    pub fn stopping(&self, elapsed: f64) -> JointState {
        let stop = self.stop_from(&self.state);
        let at = |axis: usize| match &stop {
            Some(stop) if elapsed >= 0.0 => stop.axes()[axis].state_at(elapsed),
            _ => {
                let (before, now) = (self.previous[axis], self.state[axis]);
                let jerk = (now.acceleration - before.acceleration) / self.period;
                before.advanced((elapsed + self.period).min(self.period), jerk)
            }
        };
        JointState::from_axes(&core::array::from_fn(at))
    }

    /// Returns the state at the last set-point, exactly; differences of set-points would only approximate it.
    #[must_use]
    pub fn state(&self) -> JointState {
        JointState::from_axes(&self.state)
    }

    /// Returns the goal with its positions limited to the ranges and its velocities limited to the bounds.
    fn limited(&self, goal: &JointGoal, speed_share: f64) -> JointGoal {
        let speed = |axis: usize| FASTEST_GOAL * self.bounds[axis].speed * speed_share;
        let inside = |axis: usize, position: f64| {
            let range = self.goals(axis);
            position.clamp(range.lower, range.upper)
        };
        let is_finite = |joints: &Joints| joints.iter().all(|joint| joint.is_finite());
        let along =
            |velocity: &Joints, axis: usize| velocity[axis].clamp(-speed(axis), speed(axis));
        match goal {
            _ if !(speed_share > 0.0 && speed_share <= 1.0) => JointGoal::Rest,
            JointGoal::Position(to) if is_finite(to) => {
                JointGoal::Position(core::array::from_fn(|axis| inside(axis, to[axis])))
            }
            JointGoal::Moving { position, velocity }
                if is_finite(position) && is_finite(velocity) =>
            {
                JointGoal::Moving {
                    position: core::array::from_fn(|axis| inside(axis, position[axis])),
                    velocity: core::array::from_fn(|axis| {
                        let is_inside = inside(axis, position[axis]) == position[axis];
                        if is_inside {
                            along(velocity, axis)
                        } else {
                            0.0
                        }
                    }),
                }
            }
            JointGoal::Velocity(velocity) if is_finite(velocity) => {
                let velocity = |axis| velocity[axis] * speed_share;
                let within = |axis: usize| {
                    let most = self.bounds[axis].speed;
                    f64::clamp(velocity(axis), -most, most)
                };
                JointGoal::Velocity(core::array::from_fn(within))
            }
            _ => JointGoal::Rest,
        }
    }

    /// Range of the positions (rad) at which an axis (counted from 0) may rest: the range of the axis, less the
    /// distance of a stop from rest whose initial acceleration is known only to one period of jerk.
    fn goals(&self, axis: usize) -> Range {
        let (jerk, range) = (self.stops[axis].max_jerk, self.ranges[axis]);
        let stop = 3.0 * jerk * self.period * self.period * self.period;
        range.shrunk(stop.min((range.upper - range.lower) / 4.0))
    }

    /// Returns the limits for the plan to a goal, with the share `speed_share` (0 to 1) of the requested speed.
    fn limits(&self, goal: &JointGoal, speed_share: f64) -> [AxisLimits; MAX_AXES] {
        core::array::from_fn(|axis| {
            let bounds = self.bounds[axis];
            let speed = match goal {
                JointGoal::Velocity(velocity) if velocity[axis] != 0.0 => velocity[axis].abs(),
                JointGoal::Position(_) | JointGoal::Moving { .. } => bounds.speed * speed_share,
                _ => bounds.speed,
            };
            AxisLimits::from(Bounds { speed, ..bounds })
        })
    }

    /// Returns the states of the axes one period later. Each axis takes the fastest of its plans after which it can
    /// still stop within its range.
    fn planned(&self, goal: &JointGoal, limits: &[AxisLimits; MAX_AXES]) -> [AxisState; MAX_AXES] {
        let careful = match goal {
            JointGoal::Moving { position, .. } => {
                self.followed(&resting(position), limits, Synchronization::None)
            }
            _ => self.halted(limits),
        };
        let stop = self.stop_from(&self.state);
        let mut next = stop.map_or(self.state, |stop| stop.state_at(self.period));
        for candidate in [careful, self.wanted(goal, limits)].into_iter().flatten() {
            let is_safe = self.can_stop_from(&candidate);
            for axis in (0..self.arm.axes()).filter(|axis| is_safe[*axis]) {
                next[axis] = candidate[axis];
            }
        }
        next
    }

    /// Returns the states of the axes one period later on the fastest way to the goal; `None` if there is no plan.
    fn wanted(
        &self,
        goal: &JointGoal,
        limits: &[AxisLimits; MAX_AXES],
    ) -> Option<[AxisState; MAX_AXES]> {
        let target = self.target(goal);
        match goal {
            JointGoal::Position(_) => self.followed(&target, limits, Synchronization::Time),
            JointGoal::Moving { .. } => self.followed(&target, limits, Synchronization::None),
            JointGoal::Velocity(velocity) => {
                let moving = self.followed(&target, limits, Synchronization::None)?;
                let halted = self.halted(limits)?;
                Some(core::array::from_fn(|axis| match velocity[axis] {
                    0.0 => halted[axis],
                    _ => moving[axis],
                }))
            }
            JointGoal::Rest => self.halted(limits),
        }
    }

    /// Returns the states at which a goal is reached. For a velocity goal, it is the end of the range of each axis,
    /// where the axis comes to rest by itself.
    fn target(&self, goal: &JointGoal) -> [AxisState; MAX_AXES] {
        match goal {
            JointGoal::Position(to) => resting(to),
            JointGoal::Moving { position, velocity } => core::array::from_fn(|axis| AxisState {
                position: position[axis],
                velocity: velocity[axis],
                acceleration: 0.0,
            }),
            JointGoal::Velocity(velocity) => resting(&core::array::from_fn(|axis| {
                let range = self.goals(axis);
                match velocity[axis] > 0.0 {
                    true => range.upper,
                    false => range.lower,
                }
            })),
            JointGoal::Rest => self.state,
        }
    }

    /// Returns the states of the axes one period later on the way to targets that move with their velocities; `None` if
    /// there is no plan. Planned in coordinates that move with the targets, so that the plan meets them.
    fn followed(
        &self,
        target: &[AxisState; MAX_AXES],
        limits: &[AxisLimits; MAX_AXES],
        synchronization: Synchronization,
    ) -> Option<[AxisState; MAX_AXES]> {
        let plan = self.plan_to(target, limits, synchronization)?;
        Some(states_on(&plan, target, self.period))
    }

    /// Returns the states of the axes one period later if each axis comes to rest within `limits`; `None` if there is
    /// no plan.
    fn halted(&self, limits: &[AxisLimits; MAX_AXES]) -> Option<[AxisState; MAX_AXES]> {
        let options = MotionOptions {
            synchronization: Synchronization::None,
            minimum_duration: 0.0,
        };
        let halt = OnlineMotion::to_velocity(&self.state, &AT_REST, limits, options).ok()?;
        Some(halt.state_at(self.period))
    }

    /// Plans the stop of each axis on its own from `state`, with the limits of the arm; `None` if there is no plan.
    fn stop_from(&self, state: &[AxisState; MAX_AXES]) -> Option<OnlineMotion<MAX_AXES>> {
        let options = MotionOptions {
            synchronization: Synchronization::None,
            minimum_duration: 0.0,
        };
        OnlineMotion::to_velocity(state, &AT_REST, &self.stops, options).ok()
    }

    /// Returns, for each axis, true if it can stop from `state` within its range, without its velocity exceeding the
    /// limit on the way.
    ///
    /// The next motion knows this state only by differences of set-points, so its acceleration may differ by one period
    /// of jerk. Therefore two states that differ this much to both sides are checked. The distance of a stop grows with
    /// velocity and acceleration; so if a state passes, the states on the way of its stop pass, too.
    fn can_stop_from(&self, state: &[AxisState; MAX_AXES]) -> [bool; MAX_AXES] {
        let period = self.period;
        let beside = |sense: f64| {
            core::array::from_fn(|axis| AxisState {
                velocity: state[axis].velocity
                    + sense * self.stops[axis].max_jerk * period * period / 2.0,
                acceleration: state[axis].acceleration + sense * self.stops[axis].max_jerk * period,
                ..state[axis]
            })
        };
        let stops = (self.stop_from(&beside(-1.0)), self.stop_from(&beside(1.0)));
        let (Some(lower), Some(upper)) = stops else {
            return [false; MAX_AXES];
        };
        core::array::from_fn(|axis| {
            let (state, limits, range) = (state[axis], self.stops[axis], self.ranges[axis]);
            let peak = |beside: &OnlineMotion<MAX_AXES>| {
                let AxisState {
                    velocity,
                    acceleration,
                    ..
                } = beside.axes()[axis].start();
                velocity + acceleration * acceleration.abs() / (2.0 * limits.max_jerk)
            };
            state.velocity.abs().max(peak(&upper)).max(-peak(&lower)) <= limits.max_velocity
                && lower.axes()[axis].position_extrema().min >= range.lower - OUTSIDE
                && upper.axes()[axis].position_extrema().max <= range.upper + OUTSIDE
        })
    }

    fn is_at(&self, goal: &JointGoal) -> bool {
        let target = self.target(goal);
        (0..self.arm.axes()).all(|axis| {
            let (state, target) = (self.state[axis], target[axis]);
            let speed = match goal {
                JointGoal::Velocity(velocity) => velocity[axis],
                JointGoal::Rest => 0.0,
                _ => target.velocity,
            };
            let place = match goal {
                // The goal has moved on since the cycle began.
                JointGoal::Position(_) | JointGoal::Moving { .. } => {
                    (state.position - target.position - target.velocity * self.period).abs()
                }
                _ => 0.0,
            };
            place < SAME && (state.velocity - speed).abs() < SAME && state.acceleration.abs() < 1e-6
        })
    }

    /// Returns the first axis, counted from 0, that rests at the end of its range although its commanded velocity leads
    /// beyond; `None` if no axis does.
    fn axis_at_end(&self, goal: &JointGoal) -> Option<usize> {
        let JointGoal::Velocity(velocity) = goal else {
            return None;
        };
        let target = self.target(goal);
        (0..self.arm.axes()).find(|axis| {
            let (state, target) = (self.state[*axis], target[*axis]);
            velocity[*axis] != 0.0
                && (state.position - target.position).abs() < SAME
                && state.velocity.abs() < SAME
        })
    }
}

/// Returns the states of axes at rest at these positions (rad).
fn resting(positions: &Joints) -> [AxisState; MAX_AXES] {
    positions.map(|position| AxisState {
        position,
        ..AxisState::default()
    })
}
