//! Notices: a bounded log of events in the core.

use crate::command::Ending;
use crate::error::CommandError;
use crate::ids::{CommandId, RuleId};

use rpi_device::Discontinuity;

use alloc::boxed::Box;
use alloc::vec;

/// An event in the life of a command or a rule.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Notice {
    /// A ready command was scheduled by a new rule.
    Scheduled {
        /// Command that now waits for the rule.
        command: CommandId,
    },
    /// A command was cancelled.
    Cancelling {
        /// Command whose input `cancel` is true from now on.
        command: CommandId,
    },
    /// A command was started.
    Started {
        /// Command that runs from now on.
        command: CommandId,
        /// Tick of the command's first cycle.
        tick: u64,
    },
    /// A command has ended.
    Ended {
        /// Command that has ended.
        command: CommandId,
        /// Tick of the command's last cycle, or the next tick if it ended between two ticks.
        tick: u64,
        /// Cause of the end, error number and circumstances.
        ending: Ending,
    },
    /// No rule can start a scheduled command any more.
    Orphaned {
        /// Scheduled command that lost its last rule.
        command: CommandId,
        /// True if the command is ready again; false if it is removed and can be taken out with
        /// [`crate::Core::take_orphan`].
        kept: bool,
    },
    /// An ended command has left an actuator in motion, and its device brakes.
    Braked {
        /// Id of the command that ended while the actuator was moving.
        command: CommandId,
        /// Number of the actuator (resource) that was still moving.
        resource: u32,
        /// Number of the tick in which the command ended, counted since the core was created.
        tick: u64,
    },
    /// The first set-points of a command after a takeover do not continue those of its predecessor within the limits of
    /// the device.
    Discontinuity {
        /// The command that took over.
        command: CommandId,
        /// Resource, quantity, value and limit of the discontinuity.
        discontinuity: Discontinuity,
    },
    /// A rule was removed from the table because it fired, failed, was withdrawn or can no longer fire.
    Rule {
        /// Rule that was removed.
        rule: RuleId,
        /// Reason for which the rule was removed.
        outcome: RuleOutcome,
    },
}

/// Reason for which a rule was removed from the table.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum RuleOutcome {
    /// The rule has fired: its actions have been carried out.
    Fired,
    /// The condition was true, but a command could not be started. The rule had no effect.
    Failed(CommandError),
    /// The rule could no longer fire, or was withdrawn.
    Dropped,
}

/// Ring buffer of the notices (events of commands and rules) that the host has not read yet. A notice that does not fit
/// is counted and lost.
#[derive(Clone)]
pub(crate) struct NoticeLog {
    ring: Box<[Option<Notice>]>,
    first: usize,
    len: usize,
    pub(crate) lost: u64,
}

impl NoticeLog {
    pub(crate) fn with_capacity(capacity: usize) -> Self {
        NoticeLog {
            ring: vec![None; capacity.max(1)].into(),
            first: 0,
            len: 0,
            lost: 0,
        }
    }

    pub(crate) fn push(&mut self, notice: Notice) {
        if self.len == self.ring.len() {
            // Keeps the oldest notices, so that a slow reader still sees a prefix in order; the rest is counted in
            // `lost`.
            self.lost += 1;
            return;
        }
        let at = (self.first + self.len) % self.ring.len();
        self.ring[at] = Some(notice);
        self.len += 1;
    }

    pub(crate) fn pop(&mut self) -> Option<Notice> {
        let notice = self.ring[self.first].take()?;
        self.first = (self.first + 1) % self.ring.len();
        self.len -= 1;
        Some(notice)
    }
}
