//! Set-points of the axes for goals that a program computes cycle by cycle, such as the sum of two motions.
//!
//! While the goals keep the limits of all axes, the set-points are the goals, without a lag. Where a goal would exceed a
//! limit, or would leave no way to stop, the axis follows the goals as closely as its limits allow ([`JointMotion`]),
//! converges to them where it is near, and takes them up exactly again once it has caught up.
//!
//! The limits hold in each cycle, for any goals. A goal is taken exactly only if the backward differences that it leads to
//! keep the limits, and if the axis can stop from there. A planned step begins on the parabola through the last three
//! set-points, so its differences keep the limits, too ([`JointState::from_differences`]).

use crate::joint_motion::{JointGoal, JointMotion, Share};
use crate::node::{USED_JERK_SHARE, USED_SHARE};
use crate::{Arm, JointState, Joints, MotionError};
use rpi_kin::AxisLimits;
use rpi_kin::state_to_rest::Bounds;

/// Positions of all axes (rad), and their first and second backward differences (rad/s, rad/s²).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BackwardDifferences {
    /// Positions of the axes, rad.
    pub position: Joints,
    /// First backward differences, rad/s.
    pub velocity: Joints,
    /// Second backward differences, rad/s².
    pub acceleration: Joints,
}

impl BackwardDifferences {
    /// Returns the differences after the positions `next` (rad), which follow after `period` (s).
    fn after(&self, next: &Joints, period: f64) -> Self {
        let velocity = core::array::from_fn(|axis| (next[axis] - self.position[axis]) / period);
        Self {
            position: *next,
            velocity,
            acceleration: core::array::from_fn(|axis| {
                (velocity[axis] - self.velocity[axis]) / period
            }),
        }
    }

    /// Returns true if the differences of an axis, counted from 0, keep this share of its limits when it moves to a position (rad)
    /// within a period (s).
    fn axis_keeps(
        &self,
        axis: usize,
        position: f64,
        limits: &AxisLimits,
        (share, period): (Share, f64),
    ) -> bool {
        let velocity = (position - self.position[axis]) / period;
        let acceleration = (velocity - self.velocity[axis]) / period;
        let jerk = (acceleration - self.acceleration[axis]) / period;
        let (used, used_jerk) = match share {
            Share::Planned => (USED_SHARE, USED_JERK_SHARE),
            Share::Whole => (1.0, 1.0),
        };
        libm::fabs(velocity) <= used * limits.velocity
            && libm::fabs(acceleration) <= used * limits.acceleration
            && libm::fabs(jerk) <= used_jerk * limits.jerk
    }

    fn state(&self, period: f64) -> JointState {
        JointState::from_differences(self.position, self.velocity, self.acceleration, period)
    }
}

/// Set-point of a [`JointTracker`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedSetPoint {
    /// Positions of the axes, rad.
    pub joints: Joints,
    /// Largest distance of an axis from the goal, rad; infinite without a goal.
    pub deviation: f64,
}

/// Follows goals of the axes of one arm, which are given in each cycle.
#[derive(Clone, Debug)]
pub struct JointTracker {
    arm: Arm,
    motion: JointMotion,
    /// Period of the set-points, s.
    period: f64,
    last: BackwardDifferences,
    /// The last goal, and the number of successive goals up to it; no goal if 0.
    goal: BackwardDifferences,
    goals: u32,
}

/// Factors by which the distance from the goals decays in a cycle, of which the first possible one is taken: 0 is the goal itself.
///
/// A time-optimal plan has the largest jerk at each moment, so by itself it would oscillate about a goal that accelerates, or is very
/// near. From there, the axis converges without oscillation.
const DECAYS: [f64; 2] = [0.0, 0.93];

/// Distance from the goals (rad) from which an axis is at the next goal exactly. The step needs three times this distance within three
/// cycles, a jerk of 1.5 rad/s³ at 1 kHz.
const NEAR: f64 = 5e-10;

/// Share of the jerk that plans use. From the last phase of such a plan, the axis converges with at most 1.81 times its jerk (by
/// simulation of all beginnings), so nothing leads back to the plan.
const PLANNED_JERK: f64 = 0.5;

/// Distances of the last three set-points from their goals (rad), the newest first.
#[derive(Clone, Copy, Debug)]
struct Errors {
    last: [Joints; 3],
}

impl Errors {
    /// Returns the next distance (rad) of an axis, counted from 0, such that the distances decay by the factor `decay` in each
    /// cycle, after a transient that decays as fast: three equal poles. NaN for the factor 0 if the axis is too far from the goals:
    /// it could be at the next one within its limits, but not at those after it.
    fn decayed(&self, axis: usize, decay: f64) -> f64 {
        let [newest, before, oldest] = self.last.map(|errors| errors[axis]);
        let far = [newest, before, oldest].map(libm::fabs);
        if decay == 0.0 && far.into_iter().fold(0.0, f64::max) > NEAR {
            return f64::NAN;
        }
        decay * (3.0 * newest - decay * (3.0 * before - decay * oldest))
    }
}

/// Bounds that exceed the limits of every axis, so that only the limits apply.
const UNBOUNDED: Bounds = Bounds {
    speed: 1e6,
    acceleration: 1e9,
    jerk: 1e12,
};

impl JointTracker {
    /// Creates the tracker of an arm that is at rest at joint positions 0. `period` is the time between set-points, s.
    #[must_use]
    pub fn new(arm: Arm, period: f64) -> Self {
        Self {
            arm,
            motion: JointMotion::new(arm, period),
            period,
            last: BackwardDifferences::default(),
            goal: BackwardDifferences::default(),
            goals: 0,
        }
    }

    /// Begins to follow goals after the set-points `last`. `period` is the time between set-points, s; `last_period` is that
    /// of the differences of `last`.
    ///
    /// # Errors
    /// [`MotionError::NotFinite`] if a number is not finite. The tracker is then unchanged.
    pub fn begin(
        &mut self,
        last: &BackwardDifferences,
        last_period: f64,
        period: f64,
    ) -> Result<(), MotionError> {
        self.motion
            .begin(&last.state(last_period), UNBOUNDED, period)?;
        self.motion.scale_jerk(PLANNED_JERK);
        self.last = *last;
        self.period = period;
        self.goals = 0;
        Ok(())
    }

    /// Returns the last goal (joint positions, rad); `None` if the last cycle had none.
    #[must_use]
    pub fn last_goal(&self) -> Option<&Joints> {
        (self.goals > 0).then_some(&self.goal.position)
    }

    /// Returns the set-point of the next cycle for the goal of this cycle: joint positions (rad) at the time of the
    /// set-point. Without a goal, or with one that is not finite, the axes come to rest as fast as their limits allow. Call it
    /// once per period.
    pub fn next_set_point(&mut self, goal: Option<&Joints>) -> TrackedSetPoint {
        let goal = goal.filter(|goal| goal.iter().all(|joint| joint.is_finite()));
        let errors = self.errors();
        let moving = self.moving_goal(goal);
        let mut candidates = [self.last.state(self.period); DECAYS.len()];
        let mut count = 0;
        if let Some(goal) = goal {
            // The history of a goal that has jumped says nothing.
            let errors = errors.filter(|_| self.goals > 2);
            for decay in DECAYS.iter().take(errors.map_or(1, |_| DECAYS.len())) {
                let error = |axis: usize| errors.map_or(0.0, |errors| errors.decayed(axis, *decay));
                let at = core::array::from_fn(|axis| goal[axis] + error(axis));
                candidates[count] = self.last.after(&at, self.period).state(self.period);
                count += 1;
            }
        }
        let (last, limits, period) = (self.last, self.arm.limits(), self.period);
        let keeps = |axis: usize, position: f64, share: Share| {
            last.axis_keeps(axis, position, &limits[axis], (share, period))
        };
        let next = self.motion.next_of(&candidates[..count], &moving, keeps);
        self.last = self.last.after(&next.position, self.period);
        let distance = |goal: &Joints| {
            let both = goal.iter().zip(&next.position).take(self.arm.axes());
            both.map(|(goal, at)| libm::fabs(goal - at))
                .fold(0.0, f64::max)
        };
        TrackedSetPoint {
            joints: next.position,
            deviation: goal.map_or(f64::INFINITY, distance),
        }
    }

    /// Returns the distances of the last three set-points from their goals; `None` if there were fewer goals.
    fn errors(&self) -> Option<Errors> {
        let of = |set_point: &Joints, goal: &Joints| {
            core::array::from_fn(|axis| set_point[axis] - goal[axis])
        };
        let at = of(&self.last.position, &self.goal.position);
        let velocity = of(&self.last.velocity, &self.goal.velocity);
        let acceleration = of(&self.last.acceleration, &self.goal.acceleration);
        let period = self.period;
        (self.goals > 2).then(|| Errors {
            last: [
                at,
                core::array::from_fn(|axis| at[axis] - velocity[axis] * period),
                core::array::from_fn(|axis| {
                    at[axis] - 2.0 * velocity[axis] * period + acceleration[axis] * period * period
                }),
            ],
        })
    }

    /// Returns the goal as one that moves with the velocity of the last goals. If an axis would have to move faster than it
    /// can, the goal has jumped, and its velocity is unknown.
    fn moving_goal(&mut self, goal: Option<&Joints>) -> JointGoal {
        let Some(goal) = goal else {
            self.goals = 0;
            return JointGoal::Rest;
        };
        let mut next = self.goal.after(goal, self.period);
        let mut limits = self.arm.limits().iter().zip(&next.velocity);
        if limits.any(|(limits, velocity)| libm::fabs(*velocity) > limits.velocity) {
            self.goals = 0;
        }
        self.goals = self.goals.saturating_add(1).min(3);
        if self.goals < 2 {
            next.velocity = Joints::default();
        }
        if self.goals < 3 {
            next.acceleration = Joints::default();
        }
        self.goal = next;
        let velocity = next.state(self.period).velocity;
        JointGoal::Moving {
            // Where the goal is one period before the set-point.
            position: core::array::from_fn(|axis| goal[axis] - velocity[axis] * self.period),
            velocity,
        }
    }
}
