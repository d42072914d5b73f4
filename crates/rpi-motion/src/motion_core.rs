//! The motion core of one arm: begins a motion from any state, and gives the set-point of each cycle.

mod approach;
mod passage;

use self::approach::Approach;
use crate::course::Course;
use crate::entry::{self, ATTEMPTS};
use crate::node::Node;
use crate::path::Path;
use crate::path_error::{PathError, PathErrorKind};
use crate::plan::{Demand, Planner};
use crate::ranges::{Ranges, allowed_ranges, extend_around, first_outside, whole_ranges};
use crate::set_point::{Controls, EntryPreference, MotionError, SetPoint};
use crate::speed_limit::{SpeedLimit, slower};
use crate::time_law::{HeldBrake, PathState, REPLAN_PERIOD};
use crate::tool_trace::ToolTrace;
use crate::verify::Verifier;
use crate::work_budget::WorkBudget;
use crate::{Arm, JointState, Joints};
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{MAX_AXES, Pose};

/// Motion core of one arm: it computes the set-points of a motion along a path, cycle by cycle.
#[derive(Clone, Debug)]
pub struct MotionCore {
    arm: Arm,
    /// Period of the set-points, s.
    period: f64,
    /// Path, time law and residuals (decaying differences between arm and path) of the present motion.
    course: Course,
    /// Course of the previous motion, which the arm follows until the takeover begins.
    previous: Course,
    planner: Planner,
    /// Ranges of the axes that the motion keeps, rad.
    ranges: Ranges,
    /// Number of the next cycle of the motion, from 0. Its set-point is the one at the time `(cycle + 1) * period`.
    cycle: u64,
    /// Index into [`ATTEMPTS`] of the takeover that is tried next; the length of the list if none is to be tried any
    /// more.
    attempt: usize,
    preference: EntryPreference,
    work: WorkBudget,
    /// Takeover within the bounds of the tool that is prepared while the arm follows its previous motion; `None`
    /// without one.
    approach: Option<Approach>,
    trace: ToolTrace,
}

/// Maximum number of nodes (places with derivatives) in the table of a path: 1 MB, twice for each arm, for its present
/// and its previous motion.
const NODES: usize = 4096;

/// Cycle of a motion, counted from its start, from which a faster takeover on to the path is planned:
/// by then enough places of the path have been computed.
const ENTRY_CYCLE: u64 = 6;

/// Share of the requested bounds of the tool that the motion along the path uses while a residual decays; 1 is all of
/// them.
const SHARE_WITH_RESIDUAL: f64 = 1.0;

impl MotionCore {
    /// Creates the core of an arm at rest. `period` is the time between set-points, s. Allocates.
    #[must_use]
    pub fn new(arm: Arm, period: f64) -> Self {
        Self {
            ranges: allowed_ranges(&arm, &[0.0; MAX_AXES]),
            arm,
            period,
            course: Course::new(NODES),
            previous: Course::new(NODES),
            planner: Planner::default(),
            cycle: 0,
            attempt: ATTEMPTS.len(),
            preference: EntryPreference::default(),
            work: WorkBudget::default(),
            approach: None,
            trace: ToolTrace::default(),
        }
    }

    /// Sets the way in which the arm comes on to the next path. Call it before [`MotionCore::begin`].
    pub fn set_entry_preference(&mut self, preference: EntryPreference) {
        self.preference = preference;
    }

    /// Sets the maximum work of the following cycles.
    pub fn set_work_budget(&mut self, work: WorkBudget) {
        self.work = work;
    }

    /// Begins a motion along `path` from `state`, the state of the arm as commanded, in place of the present motion.
    /// During a motion of this core, `state` must be that of [`MotionCore::state`]. `requested` are the bounds of the
    /// tool along the path (m and s), or of the axis that moves farthest on a joint line (rad and s). The path may
    /// start elsewhere than the arm: the difference decays during the motion.
    ///
    /// # Errors
    /// A [`MotionError`] if the start of the path cannot be reached or a number is not usable. The present motion then
    /// continues.
    pub fn begin(
        &mut self,
        path: Path,
        state: &JointState,
        requested: Bounds,
    ) -> Result<(), MotionError> {
        self.begin_at(path, &state.position, state, requested)
    }

    /// Begins a motion along `path` from `state`, the state of the arm as commanded, like [`MotionCore::begin`].
    /// `start` are joint positions (rad) at the start of the path or near to it, for a path that begins elsewhere than
    /// the arm is; [`path_start`](crate::path_start()) computes them.
    ///
    /// # Errors
    /// A [`MotionError`] if the start of the path cannot be reached or a number is not usable. The present motion then
    /// continues.
    pub fn begin_at(
        &mut self,
        path: Path,
        start: &Joints,
        state: &JointState,
        requested: Bounds,
    ) -> Result<(), MotionError> {
        let is_finite = state.is_finite() && start.iter().all(|joint| joint.is_finite());
        if !(requested.are_positive() && is_finite) {
            return Err(MotionError::NotFinite);
        }
        // The arm may still follow the previous motion; then the present one has not begun.
        let spare = match self.approach {
            Some(_) => &mut self.course,
            None => &mut self.previous,
        };
        spare.table.begin(&self.arm, path, start, requested)?;
        let hint = spare.table.first_node().joints;
        if let Some(axis) =
            first_outside(&self.arm, &whole_ranges(&self.arm, &state.position), &hint)
        {
            let kind = PathErrorKind::OutOfRange { axis };
            return Err(PathError { s: 0.0, kind }.into());
        }
        spare.stand(&self.arm, hint);
        let approach = self.approach_from(state);
        let continues = self.continues(state);
        if self.approach.is_none() {
            core::mem::swap(&mut self.course, &mut self.previous);
        }
        self.set_ranges(state);
        self.cycle = 0;
        self.planner = Planner::default();
        self.attempt = ATTEMPTS.len();
        self.trace.begin(&self.arm, state, self.period, continues);
        self.approach = None;
        self.enter_by_axes(state, 0.0)?;
        if self.course.residual.end() > 0.0 {
            self.approach = approach;
        }
        Ok(())
    }

    /// Sets the ranges that the motion keeps from `state` on: those in which the arm is and its path begins and ends.
    fn set_ranges(&mut self, state: &JointState) {
        self.ranges = allowed_ranges(&self.arm, &state.position);
        for end in self.course.table.ends() {
            extend_around(&mut self.ranges, &self.arm, &end);
        }
    }

    /// Begins the takeover on to the path from `state` at a time of the motion (s): each axis approaches the start of
    /// the path on its own.
    fn enter_by_axes(&mut self, state: &JointState, time: f64) -> Result<(), MotionError> {
        let node = self.course.table.first_node();
        let residual = entry::first(&self.arm, node, state, &self.ranges, time);
        self.course.residual = residual.ok_or(MotionError::NotFinite)?;
        self.course.held = HeldBrake::standing(0.0, time);
        self.attempt = match self.course.residual.end() > time {
            true => 0,
            false => ATTEMPTS.len(),
        };
        Ok(())
    }

    /// Returns the set-point of the next cycle. Call it once per period.
    ///
    /// # Errors
    /// [`MotionError::Path`] if the inverse kinematics has no solution at the present place, although neighbouring
    /// places have one.
    pub fn next_set_point(&mut self, controls: Controls) -> Result<SetPoint, MotionError> {
        let time = self.cycle as f64 * self.period;
        let now = self.course.held.state_at(time);
        self.course
            .table
            .extend(&self.arm, self.nodes_of_cycle(), now.s - 1e-3);
        if let Some(approach) = self.approach {
            self.prepare(approach, time, controls)?;
        } else if self.course.tool.is_some_and(|tool| time < tool.end()) {
            // The law until the tool is on the path has been verified as a whole.
        } else if self.is_planning_cycle() && !controls.paused && controls.speed_share > 0.0 {
            if self.attempt < ATTEMPTS.len() {
                // Entries begin with a standing path, so it must not move before they have been tried.
                if self.cycle >= ENTRY_CYCLE {
                    self.try_entry(time, controls);
                }
            } else if !self.is_at_end(&now) {
                self.replan(now, time, controls);
            }
        }
        self.cycle += 1;
        let at = self.set_point(self.cycle as f64 * self.period)?;
        self.trace
            .push(&self.arm, &at, self.period, self.course.table.requested());
        Ok(at)
    }

    /// Begins to hold the joint positions `at` (rad), in place of the present motion, from `state`, the state of the
    /// arm as commanded: each axis moves there on its own, with all its limits. The motion is done once all axes rest
    /// there.
    ///
    /// # Errors
    /// [`MotionError::NotFinite`] if a number is not finite. The present motion then continues.
    pub fn begin_hold(&mut self, at: &Joints, state: &JointState) -> Result<(), MotionError> {
        if !(state.is_finite() && at.iter().all(|joint| joint.is_finite())) {
            return Err(MotionError::NotFinite);
        }
        self.approach = None;
        self.course.table.begin_hold(&self.arm, at);
        let continues = self.continues(state);
        self.course.stand(&self.arm, *at);
        self.ranges = allowed_ranges(&self.arm, &state.position);
        self.cycle = 0;
        self.planner = Planner::default();
        self.trace.begin(&self.arm, state, self.period, continues);
        let node = self.course.table.first_node();
        let residual = entry::standing(&self.arm, node, state, 0.0);
        self.course.residual = residual.ok_or(MotionError::NotFinite)?;
        self.attempt = ATTEMPTS.len();
        Ok(())
    }

    /// Sets the pose of the tool in the flange frame, which moves along the path of the next motion, and returns the present
    /// one. Call it right before [`MotionCore::begin`]; if that fails, set the present tool again, so that the present motion
    /// can continue.
    pub fn set_tool(&mut self, tool: Pose) -> Pose {
        let present = self.arm.tool();
        self.arm.set_tool(tool);
        present
    }

    /// Sets the period of the set-points (s) for the next motion. Call it before [`MotionCore::begin`].
    pub fn set_period(&mut self, period: f64) {
        self.period = period;
    }

    /// Returns the set-point `elapsed` seconds after the last one if no new plan follows: the arm brakes on its path.
    /// For an arm that stops on its own, in steps shorter than a period. `elapsed` may be negative, down to minus one
    /// period.
    ///
    /// # Errors
    /// [`MotionError::Path`] if the inverse kinematics has no solution at the place, although neighbouring places have
    /// one.
    pub fn braking_set_point(&mut self, elapsed: f64) -> Result<SetPoint, MotionError> {
        self.set_point(self.cycle as f64 * self.period + elapsed)
    }

    /// Returns the state of the arm at the last set-point. A motion that takes over there must begin in this state: the
    /// one that [`JointState::from_differences`] computes from set-points has an error of up to one period of jerk.
    #[must_use]
    pub fn state(&self) -> JointState {
        self.braking_state(0.0)
    }

    /// Returns the state of the arm `elapsed` seconds after the last set-point if no new plan follows: the state at the
    /// set-point of [`MotionCore::braking_set_point`].
    #[must_use]
    pub fn braking_state(&self, elapsed: f64) -> JointState {
        let time = self.cycle as f64 * self.period + elapsed;
        let (course, time) = match self.approach {
            Some(approach) => (&self.previous, approach.previous_time + time),
            None => (&self.course, time),
        };
        let state = course.state_at(&self.arm, time, &course.hint);
        state.unwrap_or_else(|_| self.trace.state(self.period))
    }

    /// Returns the reason why the path cannot be followed to its end, once it is known; `None` otherwise.
    #[must_use]
    pub fn path_error(&self) -> Option<PathError> {
        self.course.table.error()
    }

    /// Returns the slowest place within the braking distance ahead, if the motion must be slower there than requested;
    /// `None` if the requested speed is possible.
    #[must_use]
    pub fn speed_limit(&self) -> Option<SpeedLimit> {
        let now = self.course.held.state_at(self.cycle as f64 * self.period).s;
        let mut cursor = 0;
        let (table, end) = (&self.course.table, self.course.held.end());
        let nodes = table.nodes_between(now, end, &mut cursor);
        nodes.map(Node::speed_limit).fold(None, slower)
    }

    /// Returns the position along the path (m; rad on a joint line) at which the motion ends: the end of the path, or a
    /// point shortly before the place where it cannot be followed.
    #[must_use]
    pub fn goal(&self) -> f64 {
        self.course.table.goal()
    }

    /// Returns the time (s, since the start of the motion) from which the arm is on the path: all differences have
    /// decayed.
    #[must_use]
    pub fn residual_end(&self) -> f64 {
        self.course.residual_end()
    }

    /// Returns the maximum speed, acceleration and jerk of the tool on its way on to the path so far, each as a share
    /// of the requested one; more than 1 if the tool exceeded it.
    #[must_use]
    pub fn tool_shares_on_entry(&self) -> [f64; 3] {
        self.trace.worst
    }

    /// Returns the path of the present motion.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.course.path()
    }

    /// Returns the number of nodes that the present cycle may compute: few or none where a takeover or a time law is
    /// planned.
    fn nodes_of_cycle(&self) -> usize {
        match self.approach {
            // The takeover has been prepared in this cycle.
            _ if self.cycle == 0 && self.course.residual.end() > 0.0 => 0,
            Some(_) if self.cycle < ENTRY_CYCLE => self.work.nodes_at_takeover,
            Some(approach) if approach.entry.is_none() => 0,
            None if self.cycle >= ENTRY_CYCLE && self.is_planning_cycle() => {
                match self.cycles_per_plan() {
                    1 => self.work.nodes / 2,
                    _ => 0,
                }
            }
            _ => self.work.nodes,
        }
    }

    fn cycles_per_plan(&self) -> u64 {
        libm::ceil(REPLAN_PERIOD / self.period).max(1.0) as u64
    }

    fn is_planning_cycle(&self) -> bool {
        let is_entering = self.attempt > 0 && self.attempt < ATTEMPTS.len();
        self.cycle.is_multiple_of(self.cycles_per_plan()) || is_entering
    }

    fn is_at_end(&self, now: &PathState) -> bool {
        now.s >= self.path().length() - 1e-12 && now.velocity < 1e-9
    }

    fn verifier(&self) -> Verifier<'_> {
        Verifier {
            arm: &self.arm,
            table: &self.course.table,
            residual: &self.course.residual,
            ranges: &self.ranges,
        }
    }

    fn demand(&self, time: f64, controls: Controls) -> Demand {
        let share = controls.speed_share.clamp(0.0, 1.0);
        let entering = time < self.course.residual_end();
        Demand {
            speed: self.course.table.requested().speed * share,
            tool_share: if entering { SHARE_WITH_RESIDUAL } else { 1.0 },
            samples: self.work.samples,
        }
    }

    /// Tries the next takeover of [`ATTEMPTS`] from the present state of the arm, which has not moved along the path so
    /// far. If it keeps all limits, the motion follows it from now on, and no further one is tried.
    fn try_entry(&mut self, time: f64, controls: Controls) {
        let state = self.state_while_standing(time);
        let demand = self.demand(time, controls);
        let attempt = ATTEMPTS[self.attempt];
        let entry = entry::attempted(&self.verifier(), &state, time, attempt, demand);
        self.attempt += 1;
        if let Some(entry) = entry {
            self.attempt = ATTEMPTS.len();
            self.course.residual = entry.residual;
            self.course.held = entry.brake;
            self.planner.last_share = entry.share;
        }
    }

    /// Returns the state of the arm at a time of the motion (s) before it moves along the path: the start of the path
    /// plus the residual.
    fn state_while_standing(&self, time: f64) -> JointState {
        let mut state = JointState::at_rest(self.course.table.first_node().joints);
        for axis in 0..self.arm.axes() {
            let rest = self.course.residual.state_at(axis, time);
            state.position[axis] += rest.position;
            state.velocity[axis] = rest.velocity;
            state.acceleration[axis] = rest.acceleration;
        }
        state
    }

    fn replan(&mut self, now: PathState, time: f64, controls: Controls) {
        let demand = self.demand(time, controls);
        let held = self.course.held;
        let mut planner = self.planner;
        let law = planner.plan(&self.verifier(), now, time, &held, demand);
        self.planner = planner;
        if let Some(law) = law {
            self.course.held = law;
        }
    }

    fn set_point(&mut self, time: f64) -> Result<SetPoint, MotionError> {
        let Some(approach) = self.approach else {
            return self.course.set_point(&self.arm, time);
        };
        let at = self
            .previous
            .set_point(&self.arm, approach.previous_time + time)?;
        Ok(SetPoint {
            joints: at.joints,
            path: PathState::default(),
            on_path: false,
            done: false,
        })
    }
}
