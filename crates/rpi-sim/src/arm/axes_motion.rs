//! Motions of the axes without a path: the device functions `move_axes`, `follow_joints`, `move_at_velocity`, `hold` and
//! `follow_chunks`.

use super::chunks::Chunks;
use super::kinematics::PerAxis;
use super::limits::Violation;
use super::path_fault::{PathFault, out_of_range};
use crate::device::{SlotWriter, real_at};
use crate::error_code::ErrorCode;
use rpi_kin::MAX_AXES;
use rpi_kin::state_to_rest::Bounds;
use rpi_motion::time_law::PathState;
use rpi_motion::{Arm, Controls, JointGoal, JointMotion, JointState, SetPoint};

/// Kind of a motion of the axes without a path, with the target that the calling command passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AxesMotionKind {
    /// All axes move to a position and arrive at the same time. Target: the position of each axis, read once.
    ToPosition,
    /// The axes follow a moving goal. Target: position and velocity of each axis, read in each cycle.
    Follow,
    /// The axes move with given velocities. Target: the velocity of each axis, read in each cycle.
    AtVelocity,
    /// The axes come to rest and stay there. The motion has no target.
    Hold,
    /// The axes follow chunks of positions. Target: the newest chunk, read when its number changes.
    Chunks,
}

/// Motion of the axes of an arm without a path; inactive while the arm makes a motion along a path.
#[derive(Clone, Debug)]
pub(super) struct AxesMotion {
    motion: JointMotion,
    chunks: Chunks,
    kind: Option<AxesMotionKind>,
    /// Position of each axis at the end of a motion to a position, rad.
    to: PerAxis,
    /// Distance that the farthest moving axis travels during a motion to a position, rad; 0 for other motions.
    way: f64,
    at_range_end: Option<usize>,
    /// Share of the requested speed in the last cycle, from 0 to 1; 0 while the motion pauses.
    speed_share: f64,
}

/// Requested bounds that exceed the limits of every axis, so that only the limits apply.
const UNBOUNDED: Bounds = Bounds {
    speed: 1e6,
    acceleration: 1e9,
    jerk: 1e12,
};

impl AxesMotion {
    pub(super) fn new(arm: rpi_motion::Arm, tick: f64) -> Self {
        Self {
            motion: JointMotion::new(arm, tick),
            chunks: Chunks::new(arm, tick),
            kind: None,
            to: PerAxis::default(),
            way: 0.0,
            at_range_end: None,
            speed_share: 0.0,
        }
    }

    /// Returns true if the present motion of the arm is one of the axes without a path.
    pub(super) fn is_present(&self) -> bool {
        self.kind.is_some()
    }

    /// Writes what a motion along chunks reports beside its set-point.
    pub(super) fn put_chunk_report(&self, out: &mut SlotWriter<'_>) {
        self.chunks.put_report(out);
    }

    /// Marks that the arm now makes a motion along a path instead.
    pub(super) fn end(&mut self) {
        self.kind = None;
    }

    /// Returns the state of the axes `elapsed` seconds after the last set-point if the arm stops on its own.
    pub(super) fn stopping(&self, elapsed: f64) -> JointState {
        match self.kind {
            Some(AxesMotionKind::Chunks) => self.chunks.stopping(elapsed),
            _ => self.motion.stopping(elapsed),
        }
    }

    /// Returns the distance that the farthest moving axis travels, rad; 0 for a motion without a known end.
    pub(super) fn way(&self) -> f64 {
        self.way
    }

    /// Returns the time (s) from the last set-point until the farthest moving axis has travelled the distance `place`
    /// (rad), as planned in the last cycle. `None` without a plan that leads there.
    pub(super) fn time_until(&self, arm: &Arm, place: f64) -> Option<f64> {
        if self.kind != Some(AxesMotionKind::ToPosition) {
            return None;
        }
        let travelled = |state: &JointState| self.set_point(arm, state, false).path.s;
        self.motion
            .time_until(&self.to, self.speed_share, travelled, place)
    }

    /// Begins a motion from the state `state` of the arm, with the bounds `requested` for each axis. `target` are the
    /// slots of the target, `period` (s) is the time between set-points. If the motion is not possible, returns the
    /// reason, and the present motion continues.
    pub(super) fn begin(
        &mut self,
        arm: &Arm,
        kind: AxesMotionKind,
        target: &[u64],
        requested: Bounds,
        state: &JointState,
        period: f64,
    ) -> Result<(), PathFault> {
        let to = reals(target, 0, arm.axes());
        if kind == AxesMotionKind::ToPosition {
            check_ranges(arm, &to, &state.position)?;
        }
        let requested = match kind {
            AxesMotionKind::Hold => UNBOUNDED,
            _ if requested.are_positive() => requested,
            _ => return Err(ErrorCode::NOT_POSITIVE.into()),
        };
        let begun = match kind {
            AxesMotionKind::Chunks => self.chunks.begin(state, requested, period),
            _ => self.motion.begin(state, requested, period),
        };
        begun.map_err(|_| PathFault::from(ErrorCode::NOT_A_NUMBER))?;
        self.kind = Some(kind);
        self.at_range_end = None;
        self.to = to;
        self.way = match kind {
            AxesMotionKind::ToPosition => farthest(&to, &state.position, arm.axes()),
            _ => 0.0,
        };
        Ok(())
    }

    /// Returns the next set-point; `None` without a present motion. It is done while the axes are at the goal; its
    /// position along the path is the distance that the farthest moving axis has travelled, rad.
    pub(super) fn next(
        &mut self,
        arm: &Arm,
        target: &[u64],
        controls: Controls,
    ) -> Option<SetPoint> {
        let axes = arm.axes();
        if self.kind? == AxesMotionKind::Chunks {
            let (state, done) = self.chunks.next(arm, target, controls);
            return Some(self.set_point(arm, &state, done));
        }
        self.speed_share = if controls.paused {
            0.0
        } else {
            controls.speed_share
        };
        let goal = match self.kind? {
            _ if controls.paused => JointGoal::Rest,
            AxesMotionKind::ToPosition => JointGoal::Position(self.to),
            AxesMotionKind::Follow => JointGoal::Moving {
                position: reals(target, 0, axes),
                velocity: reals(target, axes, axes),
            },
            AxesMotionKind::AtVelocity => JointGoal::Velocity(reals(target, 0, axes)),
            AxesMotionKind::Hold | AxesMotionKind::Chunks => JointGoal::Rest,
        };
        let next = self.motion.next_set_point(&goal, controls.speed_share);
        self.at_range_end = next.at_range_end;
        let holds = self.kind == Some(AxesMotionKind::Hold);
        let done = next.at_goal && (holds || goal != JointGoal::Rest);
        Some(self.set_point(arm, &next.state, done))
    }

    /// Returns the set-point `elapsed` seconds after the last one if the arm stops on its own.
    pub(super) fn braking_set_point(&self, arm: &Arm, elapsed: f64) -> SetPoint {
        self.set_point(arm, &self.stopping(elapsed), false)
    }

    /// Returns an error for an axis that rests at the end of its range because the goal lies beyond; `None` if there is
    /// none.
    pub(super) fn fault(&self, arm: &Arm) -> Option<PathFault> {
        let axis = self.at_range_end.filter(|_| self.is_present())?;
        let (range, value) = (
            arm.limits()[axis].position,
            self.motion.state().position[axis],
        );
        let is_upper = (range.upper - value).abs() < (range.lower - value).abs();
        Some(PathFault {
            axis: Some(axis),
            violation: Violation {
                code: ErrorCode::RANGE_END,
                value,
                limit: if is_upper { range.upper } else { range.lower },
            },
        })
    }

    fn set_point(&self, arm: &Arm, state: &JointState, done: bool) -> SetPoint {
        let left = farthest(&self.to, &state.position, arm.axes());
        SetPoint {
            joints: state.position,
            path: PathState {
                s: (self.way - left).clamp(0.0, self.way),
                velocity: farthest(&state.velocity, &PerAxis::default(), arm.axes()),
                acceleration: farthest(&state.acceleration, &PerAxis::default(), arm.axes()),
            },
            on_path: true,
            done,
        }
    }
}

/// Reads one real for each axis from the slots `target`, beginning with the slot `from`; NaN for missing slots.
fn reals(target: &[u64], from: usize, axes: usize) -> PerAxis {
    let mut all = PerAxis::default();
    for (axis, slot) in all.iter_mut().enumerate().take(axes) {
        *slot = real_at(target, from + axis);
    }
    all
}

/// Returns the largest difference of an axis between two sets of joint positions.
fn farthest(one: &PerAxis, other: &PerAxis, axes: usize) -> f64 {
    let both = one.iter().zip(other).take(axes.min(MAX_AXES));
    both.map(|(one, other)| (one - other).abs())
        .fold(0.0, f64::max)
}

/// Checks that each axis ends within its range, or no farther out than it starts. `to` and `from` are joint positions,
/// rad.
fn check_ranges(arm: &Arm, to: &PerAxis, from: &PerAxis) -> Result<(), PathFault> {
    for (axis, limits) in arm.limits().iter().enumerate() {
        let (range, from, to) = (limits.position, from[axis], to[axis]);
        if !to.is_finite() {
            return Err(ErrorCode::NOT_A_NUMBER.into());
        }
        if to < range.lower.min(from) || to > range.upper.max(from) {
            return Err(out_of_range(axis, to, arm.limits()));
        }
    }
    Ok(())
}
