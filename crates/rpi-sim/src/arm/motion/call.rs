//! Calls of the motion functions of an arm: arguments and results as slots.

use super::super::Arm;
use super::super::axes_motion::AxesMotionKind;
use super::super::path_fault::PathFault;
use super::events::report_missed_events;
use super::{MotionKind, rests, same_joints};
use crate::device::{SlotWriter, pose_from};
use crate::error_code::ErrorCode;
use rpi_kin::Pose;
use rpi_kin::state_to_rest::Bounds;
use rpi_motion::{Controls, JointState};

/// Number of slots in the result of a motion function after the joints and the pose: distance travelled, progress,
/// speed, whether the arm is on the path, whether the motion is done, error code.
const STATUS_SLOTS: u32 = 6;

/// Number of slots of a pose.
const POSE_SLOTS: usize = 7;

/// Number of slots in the result of a motion function besides those of the joints: number of the motion, pose, status.
pub(in crate::arm) const RESULT_SLOTS: u32 = 1 + 7 + STATUS_SLOTS;

/// Arguments of a call of a motion function, split into their parts.
pub(super) struct Request<'a> {
    pub(super) motion: i64,
    pub(super) target: &'a [u64],
    pub(super) requested: Bounds,
    pub(super) controls: Controls,
    /// Pose of the frame that moves along the path, in the frame of the arm's own tool.
    pub(super) tool: Pose,
}

impl<'a> Request<'a> {
    /// Splits the arguments, which are in order: number of the motion, target, speed, acceleration, jerk, override,
    /// pause, tool. `None` if there are too few slots.
    pub(super) fn from_slots(slots: &'a [u64]) -> Option<Self> {
        let (motion, rest) = slots.split_first()?;
        let (rest, tool) = rest.split_last_chunk::<POSE_SLOTS>()?;
        let (target, rest) = rest.split_last_chunk::<5>()?;
        let [speed, acceleration, jerk, share] = [0, 1, 2, 3].map(|k| f64::from_bits(rest[k]));
        Some(Self {
            motion: motion.cast_signed(),
            target,
            requested: Bounds {
                speed,
                acceleration,
                jerk,
            },
            controls: Controls {
                speed_share: if share >= 0.0 { share.min(1.0) } else { 0.0 },
                paused: rest[4] != 0,
            },
            tool: pose_from(tool),
        })
    }
}

/// Writes the result of a call of a motion function that computes no set-point: joints and pose are NaN.
pub(super) fn put_error(number: i64, axes: usize, error: ErrorCode, out: &mut SlotWriter<'_>) {
    out.put_bits(number.cast_unsigned());
    out.put_reals(core::iter::repeat_n(f64::NAN, axes + 7));
    out.put_reals([0.0; 3]);
    out.put_bits(0);
    out.put_bits(0);
    out.put_bits(error.0.cast_unsigned());
}

impl Arm {
    /// Calls the motion function for motions of this kind and writes its result to `out`. Returns false if there are
    /// too few arguments.
    pub(in crate::arm) fn call_motion(
        &mut self,
        kind: MotionKind,
        arguments: &[u64],
        out: &mut SlotWriter<'_>,
    ) -> bool {
        let Some(request) = Request::from_slots(arguments) else {
            return false;
        };
        let is_due = self.motion.is_due(self.time) && request.motion == self.motion.number;
        let jog = self
            .motion
            .jog
            .filter(|_| is_due && self.motion.rejected.is_none());
        if request.motion == 0 || jog.is_some_and(|jog| jog.is_outdated(request.target, self.time))
        {
            self.begin_motion(kind, &request);
        } else if !is_due {
            put_error(request.motion, self.axes(), ErrorCode::SUPERSEDED, out);
            put_chunk_report(self, kind, out);
            return true;
        }
        self.put_motion(&request, out);
        put_chunk_report(self, kind, out);
        true
    }

    fn begin_motion(&mut self, kind: MotionKind, request: &Request<'_>) {
        report_missed_events(self);
        let differences = JointState::from_differences(
            self.commanded(|state| state.position),
            self.commanded(|state| state.velocity),
            self.commanded(|state| state.acceleration),
            self.motion.accepted_period,
        );
        let period = self.tick * f64::from(self.set_point_ticks);
        let followed = self.motion.period == period
            && self.motion.is_due(self.time)
            && same_joints(&differences.position, &self.motion.last[0]);
        let state = self.motion.state(followed, &differences.position);
        let state = state.unwrap_or(differences);
        self.motion.period = period;
        if let Err(PathFault { axis, violation }) = self
            .motion
            .begin(kind, request, &state, followed, self.time)
        {
            self.report(axis, violation);
        }
    }

    /// Computes the next set-point of the present motion and writes the result of the call to `out`.
    fn put_motion(&mut self, request: &Request<'_>, out: &mut SlotWriter<'_>) {
        let number = self.motion.number;
        self.motion.computed = self.time;
        let Some(at) = self.motion.next(request) else {
            self.motion.error = ErrorCode::NOT_A_NUMBER;
            return put_error(number, self.axes(), ErrorCode::NOT_A_NUMBER, out);
        };
        if let Some(PathFault { axis, violation }) = self.motion.check(&at) {
            self.report(axis, violation);
        }
        let motion = &mut self.motion;
        if let Some(code) = motion.rejected.filter(|_| rests(&at)) {
            motion.error = code;
        }
        let done = core::mem::replace(&mut motion.at_end, at.done) && at.done;
        let (progress, speed) = motion.progress(&at);
        let (way, error) = (motion.way, motion.error);
        motion.events.advance(way, progress);
        out.put_bits(number.cast_unsigned());
        out.put_reals(at.joints.into_iter().take(self.axes()));
        out.put_pose(&self.motion.pose_of_tool(&at.joints));
        out.put_reals([progress * way, progress, speed]);
        out.put_bits(u64::from(at.on_path && error == ErrorCode::OK));
        out.put_bits(u64::from(done && error == ErrorCode::OK));
        out.put_bits(error.0.cast_unsigned());
    }
}

fn put_chunk_report(arm: &Arm, kind: MotionKind, out: &mut SlotWriter<'_>) {
    if kind == MotionKind::Axes(AxesMotionKind::Chunks) {
        arm.motion.axes.put_chunk_report(out);
    }
}
