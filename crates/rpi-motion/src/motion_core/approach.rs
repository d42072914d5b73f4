//! Takeover within the bounds of the tool: prepared while the arm follows its previous motion.

use super::{ENTRY_CYCLE, MotionCore};
use crate::entry::ATTEMPTS;
use crate::path::Path;
use crate::residual::Residual;
use crate::set_point::{Controls, EntryPreference, MotionError};
use crate::tool_entry::{Situation, ToolEntry, Verification};
use crate::{JointState, Joints};

/// Difference of joint positions, rad, below which two set-points count as the same.
const SAME_JOINTS: f64 = 1e-9;

/// Latest cycle of a motion, counted from its start, in which a takeover within the bounds of the tool begins. The arm
/// brakes on the path of its previous motion until then.
const LATEST_SWITCH: u64 = 48;

/// Preparation of a takeover within the bounds of the tool, while the arm follows its previous motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Approach {
    /// Time of the previous motion (s) at the start of the present motion.
    pub(super) previous_time: f64,
    /// Cycle of the present motion in which the takeover begins.
    switch: u64,
    /// The planned takeover; `None` until it is planned.
    pub(super) entry: Option<ToolEntry>,
    /// True if no takeover could be planned, so that each axis approaches the path on its own.
    has_failed: bool,
}

impl MotionCore {
    /// Returns true if `state` has the joint positions of the last set-point.
    pub(super) fn continues(&self, state: &JointState) -> bool {
        let followed = match self.approach {
            Some(_) => &self.previous,
            None => &self.course,
        };
        let last = self.trace.joints(0);
        let differs = |axis: usize| (last[axis] - state.position[axis]).abs() > SAME_JOINTS;
        followed.moved_tool == self.arm.tool() && !(0..self.arm.axes()).any(differs)
    }

    /// Returns the preparation of a takeover from the motion that the arm follows; `None` if the arm is not in this
    /// motion at `state`, or if a takeover within the bounds of the tool is not wanted.
    pub(super) fn approach_from(&self, state: &JointState) -> Option<Approach> {
        let time = self.cycle as f64 * self.period;
        let (previous_time, path) = match self.approach {
            Some(approach) => (approach.previous_time + time, self.course.path()),
            None => (time, self.previous.path()),
        };
        let is_wanted = self.preference == EntryPreference::WithinToolBounds
            && matches!(path, Path::Tool(_))
            && self.cycle > 0;
        (is_wanted && self.continues(state)).then_some(Approach {
            previous_time,
            switch: LATEST_SWITCH,
            entry: None,
            has_failed: false,
        })
    }

    /// Plans and verifies the takeover within the bounds of the tool over several cycles, and begins it in its cycle.
    /// If it is not possible, each axis approaches the path on its own. `time` is the time of the motion, s.
    pub(super) fn prepare(
        &mut self,
        mut approach: Approach,
        time: f64,
        controls: Controls,
    ) -> Result<(), MotionError> {
        if self.cycle < ENTRY_CYCLE {
            return Ok(());
        }
        let situation = Situation {
            arm: &self.arm,
            table: &self.course.table,
            ranges: &self.ranges,
            demand: self.demand(time, controls),
            period: self.period,
            set_points: self.work.set_points,
        };
        if approach.entry.is_none() && !approach.has_failed {
            self.plan_switch(&mut approach, &situation);
            // What follows in either case has work of its own, for the next cycle.
            approach.has_failed = approach.entry.is_none();
            self.approach = Some(approach);
            return Ok(());
        }
        let verified = approach
            .entry
            .as_mut()
            .map(|entry| entry.verify(&situation));
        let is_stopped = controls.paused || controls.speed_share <= 0.0;
        match (verified, approach.entry) {
            (Some(Verification::Accepted), Some(entry)) if !is_stopped => {
                self.approach = Some(approach);
                if self.cycle >= approach.switch {
                    self.begin_tool_entry(&entry);
                }
                Ok(())
            }
            (Some(Verification::Running), _) if !is_stopped && self.cycle < approach.switch => {
                self.approach = Some(approach);
                Ok(())
            }
            _ => {
                let state = self.state();
                self.approach = None;
                self.set_ranges(&state);
                self.enter_by_axes(&state, time)
            }
        }
    }

    /// Plans the takeover for the first cycle by which its verification can be completed.
    fn plan_switch(&self, approach: &mut Approach, situation: &Situation<'_>) {
        /// Number of cycles that the first plan of a takeover leaves for its verification. Each plan shows how many it
        /// needs.
        const FIRST_GUESS: u64 = 16;
        /// Maximum number of plans of a takeover. Each later plan begins the takeover in the cycle that the
        /// verification of the previous plan would need.
        const PLANS: usize = 2;
        let mut situation = *situation;
        situation.demand.samples /= PLANS;
        approach.switch = self.cycle + FIRST_GUESS;
        for _ in 0..PLANS {
            let time = approach.switch as f64 * self.period;
            let planned = self
                .ahead(approach)
                .and_then(|(state, last)| ToolEntry::plan(&situation, time, &state, last));
            let Some(entry) = planned else { return };
            let needed = self.cycle + entry.cycles(&situation) + 1;
            if needed <= approach.switch {
                approach.entry = Some(entry);
                return;
            }
            if needed > LATEST_SWITCH {
                return;
            }
            approach.switch = (needed + 2).min(LATEST_SWITCH);
        }
    }

    /// Returns the state at the beginning of the takeover and the last four set-points up to it, including those that
    /// are still to come; `None` if one has no inverse kinematics.
    fn ahead(&self, approach: &Approach) -> Option<(JointState, [Joints; 4])> {
        let to_come = approach.switch.saturating_sub(self.cycle) as usize;
        let mut joints = [*self.trace.joints(0); 4];
        let mut hint = self.previous.hint;
        let time = |cycle: u64| approach.previous_time + cycle as f64 * self.period;
        for ahead in 1..=to_come as u64 {
            let at = time(self.cycle + ahead);
            let next = self.previous.joints_at(&self.arm, at, &hint).ok()?;
            joints.rotate_left(1);
            (joints[3], hint) = next;
        }
        let switch = time(approach.switch);
        let state = self.previous.state_at(&self.arm, switch, &hint).ok()?;
        Some((state, joints))
    }

    fn begin_tool_entry(&mut self, entry: &ToolEntry) {
        self.approach = None;
        self.attempt = ATTEMPTS.len();
        self.course.residual = Residual::default();
        self.course.tool = Some(entry.residual);
        self.course.held = entry.law;
        self.course.hint = self.previous.hint;
        self.planner.last_share = 1;
    }
}
