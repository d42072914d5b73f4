//! Takeover within the bounds of the tool: prepared while the arm follows its previous motion.

use super::{ENTRY_CYCLE, MotionCore};
use crate::course::state_of;
use crate::entry::ATTEMPTS;
use crate::path::Path;
use crate::residual::Residual;
use crate::set_point::{Controls, EntryPreference, MotionError};
use crate::tool_entry::{Situation, ToolEntry, Verification};
use crate::verify::allowed_ranges;
use crate::{JointState, Joints};

/// Difference of the joints below which two set-points are the same, rad.
const SAME_JOINTS: f64 = 1e-9;

/// Latest cycle in which a takeover within the bounds of the tool begins: the arm follows the brake of its previous motion
/// until then.
const LATEST_SWITCH: u64 = 48;

/// Preparation of a takeover within the bounds of the tool.
#[derive(Clone, Copy, Debug)]
pub(super) struct Approach {
    /// Time of the previous motion at the start of the present one, s.
    pub(super) previous_time: f64,
    /// Cycle in which the takeover begins.
    switch: u64,
    /// The takeover; `None` until it is planned.
    pub(super) entry: Option<ToolEntry>,
}

impl MotionCore {
    /// Returns whether a state is that of the last set-point.
    pub(super) fn continues(&self, state: &JointState) -> bool {
        let last = self.trace.joints(0);
        let differs = |axis: usize| (last[axis] - state.position[axis]).abs() > SAME_JOINTS;
        !(0..self.arm.axes()).any(differs)
    }

    /// Returns the preparation of a takeover from the motion that the arm follows, if it does so in this state.
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
        })
    }

    /// Prepares the takeover within the bounds of the tool, and begins it in its cycle. If it is not possible, each axis
    /// comes on to the path on its own.
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
        };
        if approach.entry.is_none() {
            self.plan_switch(&mut approach, &situation);
            if approach.entry.is_some() {
                self.approach = Some(approach);
                return Ok(());
            }
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
                let last = core::array::from_fn(|k| *self.trace.joints(3 - k));
                let state = state_of(&last, self.period);
                self.approach = None;
                self.ranges = allowed_ranges(&self.arm, &state.position);
                self.enter_by_axes(&state, time)
            }
        }
    }

    /// Plans the takeover for the first cycle in which its verification can be done.
    fn plan_switch(&self, approach: &mut Approach, situation: &Situation<'_>) {
        /// Number of cycles until the takeover of the first plan, and number of plans: each one shows how long its
        /// verification takes.
        const FIRST_GUESS: u64 = 16;
        const PLANS: usize = 2;
        approach.switch = self.cycle + FIRST_GUESS;
        for _ in 0..PLANS {
            let time = approach.switch as f64 * self.period;
            let last = self.set_points_ahead(approach);
            let Some(entry) = last.and_then(|last| ToolEntry::plan(situation, time, last)) else {
                return;
            };
            let needed = self.cycle + entry.cycles() + 1;
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

    /// Returns the last set-points up to the takeover, those that are still to come included; `None` if one has no inverse.
    fn set_points_ahead(&self, approach: &Approach) -> Option<[Joints; 4]> {
        let to_come = approach.switch.saturating_sub(self.cycle) as usize;
        let mut joints = [*self.trace.joints(0); 4];
        let mut hint = self.previous.hint;
        for ahead in 1..=to_come {
            let time = (self.cycle as f64 + ahead as f64) * self.period;
            let at = approach.previous_time + time;
            let next = self.previous.joints_at(&self.arm, at, &hint).ok()?;
            joints.rotate_left(1);
            (joints[3], hint) = next;
        }
        Some(joints)
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
