//! Takeover within the bounds of the tool: prepared while the arm follows its previous motion.

use super::{ENTRY_CYCLE, MotionCore};
use crate::course::state_of;
use crate::entry::ATTEMPTS;
use crate::path::Path;
use crate::residual::Residual;
use crate::set_point::{Controls, EntryPreference, MotionError};
use crate::tool_entry::{INVERSES_PER_CYCLE, Situation, ToolEntry, Verification, WIDEST};
use crate::verify::allowed_ranges;
use crate::{JointState, Joints};
use rpi_kin::MAX_AXES;

/// Difference of the joints below which two set-points are the same, rad.
const SAME_JOINTS: f64 = 1e-9;

/// Cycle in which a takeover within the bounds of the tool begins: the arm follows its previous motion until then, and no
/// longer than that has been planned.
const SWITCH_CYCLE: u64 = 12;

/// Number of set-points before a takeover that its plan looks at.
const AHEAD: usize = 3 * WIDEST + 1;

/// Preparation of a takeover within the bounds of the tool.
#[derive(Clone, Copy, Debug)]
pub(super) struct Approach {
    /// Time of the previous motion at the start of the present one, s.
    pub(super) previous_time: f64,
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
        let switch = SWITCH_CYCLE as f64 * self.period;
        let situation = Situation {
            arm: &self.arm,
            table: &self.course.table,
            ranges: &self.ranges,
            demand: self.demand(time, controls),
            period: self.period,
        };
        if approach.entry.is_none() {
            let budget = (SWITCH_CYCLE - ENTRY_CYCLE) as usize * INVERSES_PER_CYCLE;
            let ahead = self.set_points_ahead(approach.previous_time);
            approach.entry = ahead.and_then(|ahead| {
                ToolEntry::plan(&situation, switch, budget, |stride| {
                    core::array::from_fn(|k| ahead[ahead.len() - 1 - (3 - k) * stride])
                })
            });
        }
        let verified = approach
            .entry
            .as_mut()
            .map(|entry| entry.verify(&situation));
        let is_stopped = controls.paused || controls.speed_share <= 0.0;
        match (verified, approach.entry) {
            (Some(Verification::Accepted), Some(entry)) if !is_stopped => {
                self.approach = Some(approach);
                if self.cycle >= SWITCH_CYCLE {
                    self.begin_tool_entry(&entry);
                }
                Ok(())
            }
            (Some(Verification::Running), _) if !is_stopped && self.cycle < SWITCH_CYCLE => {
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

    /// Returns the set-points up to the takeover, those that are still to come included; `None` if one has no inverse.
    fn set_points_ahead(&self, previous_time: f64) -> Option<[Joints; AHEAD]> {
        let to_come = SWITCH_CYCLE.saturating_sub(self.cycle) as usize;
        let mut joints = [[0.0; MAX_AXES]; AHEAD];
        let mut hint = self.previous.hint;
        for (k, slot) in joints.iter_mut().enumerate() {
            let left = AHEAD - 1 - k;
            if left >= to_come {
                *slot = *self.trace.joints(left - to_come);
                continue;
            }
            let cycle = SWITCH_CYCLE as f64 - left as f64;
            let time = previous_time + cycle * self.period;
            (*slot, hint) = self.previous.joints_at(&self.arm, time, &hint).ok()?;
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
