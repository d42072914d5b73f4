//! Motions of the arm along paths: the device functions `move_line`, `move_joints`, and those of the other paths.
//!
//! A call with the motion number 0 begins a motion from the arm's state as commanded, and returns a new number; the
//! caller passes it back in each of the next cycles. The set-point of the call is that of the end of the period.

mod call;
mod events;
mod free_motion;
mod tool;

use super::axes_motion::{AxesMotion, AxesMotionKind};
use super::jog::Jog;
use super::kinematics::PerAxis;
use super::motion_path::path_from_stop;
use super::path_fault::PathFault;
use super::tool_path::ToolPathKind;
use crate::error_code::ErrorCode;
pub(super) use call::RESULT_SLOTS;
use call::Request;
use events::PathEvents;
pub(super) use events::{
    EVENT_SLOTS, call_path_event, report_events_of_ended_motion, report_missed_events,
};
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{ArmModel, AxisLimits, MAX_AXES, Pose};
use rpi_motion::PathError;
use rpi_motion::path::TwistFrame;
use rpi_motion::stop_margin::stopping_distances;
use rpi_motion::{Controls, JointState, MotionCore, MotionError, Path, SetPoint};
use tool::Tools;

/// Kind of the path along which a motion function moves the arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PathKind {
    /// Path of the tool in space.
    Tool(ToolPathKind),
    /// Straight line in joint space.
    Joints,
}

/// Kind of the motion that a motion function of the arm makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MotionKind {
    /// Motion along a path.
    Path(PathKind),
    /// Motion of the axes without a path.
    Axes(AxesMotionKind),
    /// Motion of the tool with a linear and angular velocity that are given in this frame.
    Jog(TwistFrame),
}

/// Minimum length (m, or rad) of a motion along a path. For a shorter path, the arm only holds its end.
pub(super) const SHORTEST_WAY: f64 = 1e-7;

/// Distance (m) from the end of the path that can be followed at which a motion with a velocity counts as having
/// reached this end: plans that come still nearer may all be rejected.
const NEAR_GOAL: f64 = 1e-3;

/// Difference of the numbers of two successive motions: the number of arms of a cell whose motions have different numbers.
const NUMBER_STEP: i64 = 256;

/// Number of periods after its computation up to which a set-point counts as the present one of the arm.
const PRESENT_PERIODS: f64 = 2.5;

/// Planner of the motions of an arm, and its present motion.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    core: MotionCore,
    /// Present motion of the axes without a path; inactive if the present motion has a path.
    axes: AxesMotion,
    /// Present motion of the tool with a velocity; `None` if the present motion is of another kind.
    jog: Option<Jog>,
    arm: rpi_motion::Arm,
    tools: Tools,
    /// Index of the arm in the cell, modulo [`NUMBER_STEP`].
    device: i64,
    /// Number by which a command refers to the present motion, above 0; 0 before the first motion. Its remainder by
    /// [`NUMBER_STEP`] is `device`, so that a motion of another arm has another number.
    number: i64,
    /// Simulated time at which the last set-point was computed, s.
    computed: f64,
    /// Maximum speed, acceleration and jerk of the tool for motions along paths of the tool (m, s).
    tool_limits: Bounds,
    /// Period of the set-points of the present motion, s.
    period: f64,
    /// Period of the last set-points that the arm accepted, s.
    pub(super) accepted_period: f64,
    /// Joint positions (rad) of the last two set-points, the newest first.
    last: [PerAxis; 2],
    /// Distance that the tool travels along the path, m; on a joint line, that of the farthest moving axis, rad.
    way: f64,
    /// Error because of which the motion is not possible and the arm comes to rest; `None` without an error.
    rejected: Option<ErrorCode>,
    /// Error code that the command sees, set once the arm is at rest; 0 for none.
    error: ErrorCode,
    /// True if the last set-point was the end of the motion.
    at_end: bool,
    /// Stop of the arm on its own along the path of the motion; `None` while it follows set-points.
    brake: Option<PathBrake>,
    /// Events on the path that a program waits for.
    events: PathEvents,
}

/// Stop of an arm on its own along the path of its motion.
#[derive(Clone, Copy, Debug)]
struct PathBrake {
    /// Time since the newest set-point of the motion, s.
    elapsed: f64,
    /// Number of successive ticks for which the arm has been at rest.
    rested: u32,
}

impl Motion {
    pub(super) fn new(
        model: &'static ArmModel,
        tool: Pose,
        limits: &[AxisLimits],
        tool_limits: Bounds,
        tick: f64,
        device: usize,
    ) -> Self {
        let arm = rpi_motion::Arm::new(model, tool, limits);
        Self {
            core: MotionCore::new(arm, tick),
            axes: AxesMotion::new(arm, tick),
            jog: None,
            arm,
            tools: Tools::new(tool),
            device: device as i64 % NUMBER_STEP,
            number: 0,
            computed: f64::NEG_INFINITY,
            tool_limits,
            period: tick,
            accepted_period: tick,
            last: [[f64::NAN; MAX_AXES]; 2],
            way: 0.0,
            rejected: None,
            error: ErrorCode::OK,
            at_end: false,
            brake: None,
            events: PathEvents::default(),
        }
    }

    /// Returns the maximum speed (m/s), acceleration (m/s²) and jerk (m/s³) of the tool in motions along paths of the
    /// tool.
    pub(super) fn tool_limits(&self) -> Bounds {
        self.tool_limits
    }

    /// Returns the error code of the present motion; 0 for none.
    pub(super) fn error(&self) -> ErrorCode {
        self.error
    }

    /// Clears the error code of the last motion, because another command begins.
    pub(super) fn clear_error(&mut self) {
        self.error = ErrorCode::OK;
    }

    /// Records the period (s) of the set-points that the arm has accepted.
    pub(super) fn set_accepted_period(&mut self, period: f64) {
        self.accepted_period = period;
    }

    /// Returns true if the next set-point of the motion is due at the simulated time `time` (s), so that no cycle was
    /// left out.
    fn is_due(&self, time: f64) -> bool {
        let due = self.computed + self.period;
        self.number > 0 && (time - due).abs() < self.period / 2.0
    }

    /// Returns the exact state of the arm at the joint positions `commanded` (rad), if it follows this motion
    /// (`followed`) or brakes along its path; `None` otherwise.
    fn state(&self, followed: bool, commanded: &PerAxis) -> Option<JointState> {
        let elapsed = match self.brake {
            Some(brake) => brake.elapsed,
            None if followed => 0.0,
            None => return None,
        };
        let state = match self.axes.is_present() {
            true => self.axes.stopping(elapsed),
            false => self.core.braking_state(elapsed),
        };
        same_joints(&state.position, commanded).then_some(state)
    }

    /// Begins to brake along the path if the arm, with the commanded joint positions `commanded` (rad), follows this
    /// motion at the simulated time `time` (s).
    pub(super) fn begin_braking(&mut self, commanded: &PerAxis, time: f64) {
        let recent = self.number > 0 && time - self.computed < PRESENT_PERIODS * self.period;
        let elapsed = match self
            .last
            .map(|set_point| same_joints(commanded, &set_point))
        {
            [true, _] => Some(0.0),
            // The newest set-point was dropped.
            [_, true] => Some(-self.period),
            _ => None,
        };
        self.brake = elapsed
            .filter(|_| recent)
            .map(|elapsed| PathBrake { elapsed, rested: 0 });
    }

    /// Advances the time of braking by `tick` (s). Returns the joint positions (rad); `None` if the arm does not brake
    /// along a path.
    pub(super) fn advance_brake(&mut self, tick: f64) -> Option<PerAxis> {
        let brake = self.brake.as_mut()?;
        brake.elapsed += tick;
        // The arm has left the set-points of the program, which may not go on with its motion.
        self.computed = f64::NEG_INFINITY;
        let at = match self.axes.is_present() {
            true => self.axes.braking_set_point(&self.arm, brake.elapsed),
            false => self.core.braking_set_point(brake.elapsed).ok()?,
        };
        brake.rested = if rests(&at) { brake.rested + 1 } else { 0 };
        Some(at.joints)
    }

    /// True if the arm has been at rest for more than two ticks after braking along a path. Only then are the first and
    /// second differences of its positions zero.
    pub(super) fn brake_is_finished(&self) -> bool {
        self.brake.is_some_and(|brake| brake.rested > 2)
    }

    pub(super) fn end_braking(&mut self) {
        self.brake = None;
    }

    /// Begins a motion from the state `state` of the arm at the simulated time `time` (s). `followed` is true if the
    /// arm follows the previous motion. If the motion is not possible, the arm comes to rest, and the reason is
    /// returned.
    fn begin(
        &mut self,
        kind: MotionKind,
        request: &Request<'_>,
        state: &JointState,
        followed: bool,
        time: f64,
    ) -> Result<(), PathFault> {
        self.number += match self.number {
            0 => NUMBER_STEP + self.device,
            _ => NUMBER_STEP,
        };
        let jog = self.jog.take();
        self.error = ErrorCode::OK;
        self.at_end = false;
        self.rejected = None;
        self.way = 0.0;
        if self.brake.is_some() {
            // If its first set-point is dropped, the arm goes on braking along the new motion, which begins here.
            self.brake = Some(PathBrake {
                elapsed: -self.period,
                rested: 0,
            });
        }
        let present = self.arm.tool();
        if let Err(fault) = self.choose_tool(request) {
            return self.refuse(fault, jog, followed, state);
        }
        let started = match kind {
            MotionKind::Path(kind) => self.start_path(kind, request, state),
            MotionKind::Axes(kind) => self.start_axes(kind, request, state),
            MotionKind::Jog(frame) => self.start_jog(frame, request, state, time),
        };
        match started {
            Ok(()) => Ok(()),
            Err(fault) => {
                self.set_tool(present);
                self.refuse(fault, jog, followed, state)
            }
        }
    }

    /// Makes the arm come to rest, because a motion is not possible: along the path that it is on if it follows one, with the
    /// jog `jog` if it was one. Returns the reason, `fault`.
    fn refuse(
        &mut self,
        fault: PathFault,
        jog: Option<Jog>,
        followed: bool,
        state: &JointState,
    ) -> Result<(), PathFault> {
        self.rejected = Some(fault.violation.code);
        match followed {
            true => self.jog = jog,
            false => self.hold(state),
        }
        Err(fault)
    }

    fn start_path(
        &mut self,
        kind: PathKind,
        request: &Request<'_>,
        state: &JointState,
    ) -> Result<(), PathFault> {
        let (path, from) = path_from_stop(&self.arm, kind, state, request.target)?;
        if !request.requested.are_positive() {
            return Err(ErrorCode::NOT_POSITIVE.into());
        }
        if path.length() < SHORTEST_WAY {
            self.core.set_period(self.period);
            return self.hold_end(&path, state);
        }
        self.follow(path, &from, request, state)
    }

    /// Begins to follow a path from the state `state` of the arm. `from` are the joint positions (rad) at the start of
    /// the path.
    fn follow(
        &mut self,
        path: Path,
        from: &PerAxis,
        request: &Request<'_>,
        state: &JointState,
    ) -> Result<(), PathFault> {
        self.core.set_period(self.period);
        self.way = path.way();
        let requested = match &path {
            Path::Tool(_) => least(request.requested, self.tool_limits),
            Path::Joints(_) => request.requested,
        };
        let begun = self.core.begin_at(path, from, state, requested);
        if begun.is_ok() {
            self.axes.end();
        }
        begun.map_err(|error| match error {
            MotionError::Path(error) => {
                // The core has forgotten the path that it was on.
                self.hold(state);
                self.fault(&error, &path)
            }
            MotionError::NotFinite => ErrorCode::NOT_A_NUMBER.into(),
        })
    }

    /// Makes the arm hold the end of a path that has no length.
    fn hold_end(&mut self, path: &Path, state: &JointState) -> Result<(), PathFault> {
        let end = match path {
            Path::Joints(line) => line.joints(line.length()),
            Path::Tool(tool) => {
                let (pose, near) = (tool.pose(tool.length()), &state.position);
                let arm_angle = self.arm.arm_angle(near).unwrap_or(0.0);
                let found = self.arm.inverse(&pose, near, arm_angle);
                found.map_err(PathFault::from)?.0
            }
        };
        let begun = self.core.begin_hold(&end, state);
        begun.map_err(|_| PathFault::from(ErrorCode::NOT_A_NUMBER))?;
        self.axes.end();
        Ok(())
    }

    fn fault(&self, error: &PathError, path: &Path) -> PathFault {
        PathFault::new(error, path, self.arm.limits())
    }

    /// Stops each axis on its own, as fast as its limits allow.
    fn hold(&mut self, state: &JointState) {
        let mut at = state.position;
        for (axis, limits) in self.arm.limits().iter().enumerate() {
            let (velocity, acceleration) = (state.velocity[axis], state.acceleration[axis]);
            let (below, above) = stopping_distances(velocity, acceleration, limits);
            at[axis] += above - below;
        }
        self.core.set_period(self.period);
        self.axes.end();
        // A state that is not finite has no way to rest; the next set-point is then rejected.
        let _ = self.core.begin_hold(&at, state);
    }

    fn next(&mut self, request: &Request<'_>) -> Option<SetPoint> {
        let controls = Controls {
            paused: request.controls.paused || self.rejected.is_some(),
            ..request.controls
        };
        let fastest = least(request.requested, self.tool_limits).speed;
        let controls = self.jog.as_ref().map_or(controls, |jog| {
            jog.controls(request.target, fastest, controls)
        });
        let at = match self.axes.is_present() {
            true => self.axes.next(&self.arm, request.target, controls)?,
            false => self.core.next_set_point(controls).ok()?,
        };
        self.last = [at.joints, self.last[0]];
        Some(at)
    }

    /// Returns the share of the path that has been travelled (0 to 1), and the speed along it (m/s, or rad/s).
    fn progress(&self, at: &SetPoint) -> (f64, f64) {
        let (length, speed) = match self.axes.is_present() {
            true => (self.way, at.path.velocity),
            false => {
                let length = self.core.path().length();
                (length, at.path.velocity * self.way / length)
            }
        };
        match length > 0.0 {
            true => ((at.path.s / length).min(1.0), speed),
            false if self.axes.is_present() => (1.0, speed),
            false => (1.0, 0.0),
        }
    }

    /// Checks whether the motion can continue to its end. Returns an error that was not reported before; `None` if
    /// there is none.
    fn check(&mut self, at: &SetPoint) -> Option<PathFault> {
        if self.rejected.is_some() {
            return None;
        }
        let fault = match self.axes.is_present() {
            true => self.axes.fault(&self.arm)?,
            false => self.fault(&self.core.path_error()?, self.core.path()),
        };
        // A motion with a velocity goes on to the place where it cannot go on.
        if self.jog.is_some() && !(rests(at) && self.core.goal() - at.path.s < NEAR_GOAL) {
            return None;
        }
        self.rejected = Some(fault.violation.code);
        Some(fault)
    }
}

/// Returns, for speed, acceleration and jerk, the lower one of two bounds.
fn least(one: Bounds, other: Bounds) -> Bounds {
    Bounds {
        speed: one.speed.min(other.speed),
        acceleration: one.acceleration.min(other.acceleration),
        jerk: one.jerk.min(other.jerk),
    }
}

/// Returns true if the arm rests on its path, without a remaining difference from it.
fn rests(at: &SetPoint) -> bool {
    at.on_path && at.path.velocity == 0.0 && at.path.acceleration == 0.0
}

/// Returns true if two sets of joint positions (rad) are equal, apart from rounding.
pub(super) fn same_joints(one: &PerAxis, other: &PerAxis) -> bool {
    /// Difference of an axis below which joint positions are equal: the rounding of the inverse kinematics, rad.
    const ROUNDING: f64 = 1e-9;
    let mut axes = one.iter().zip(other);
    axes.all(|(one, other)| (one - other).abs() < ROUNDING)
}
