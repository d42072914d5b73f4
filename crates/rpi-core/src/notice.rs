//! What happened, in order, until somebody asks: a bounded log inside of the core.

use crate::command::Ending;
use crate::commands::Refused;
use crate::id::{CommandId, RuleId};

use rpi_device::Jump;

use alloc::boxed::Box;
use alloc::vec;

/// Something that happened to a command or a rule.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Notice {
    /// A rule that may start a command was made, and it was ready before.
    Scheduled {
        /// Which.
        command: CommandId,
    },
    /// A command is asked to end.
    Cancelling {
        /// Which.
        command: CommandId,
    },
    /// A command runs; its first cycle is this tick.
    Started {
        /// Which.
        command: CommandId,
        /// When.
        tick: u64,
    },
    /// A command has ended; `tick` is that of its last cycle, or the next one if it ended between two.
    Ended {
        /// Which.
        command: CommandId,
        /// When.
        tick: u64,
        /// How.
        ending: Ending,
    },
    /// Nothing can start a scheduled command any more: it is ready again if it was to be kept, otherwise it is gone and
    /// can be taken out.
    Orphaned {
        /// Which.
        command: CommandId,
        /// It is ready again.
        kept: bool,
    },
    /// A command has left an actuator in motion: its device brakes on its own.
    Braked {
        /// Who left it.
        command: CommandId,
        /// The actuator.
        resource: u32,
        /// When, as its end.
        tick: u64,
    },
    /// The first set-points of a command that took over do not join those before.
    Jumped {
        /// Who took over.
        command: CommandId,
        /// Where, and by how much.
        jump: Jump,
    },
    /// A rule is over.
    Rule {
        /// Which.
        rule: RuleId,
        /// How.
        outcome: Outcome,
    },
}

/// What became of a rule.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Outcome {
    /// It has fired.
    Fired,
    /// Its condition came true, but what it was to start could not be; nothing was done.
    Failed(Refused),
    /// It can no longer fire, or was withdrawn.
    Dropped,
}

/// A ring of notices.
pub(crate) struct Notices {
    ring: Box<[Option<Notice>]>,
    first: usize,
    len: usize,
    pub(crate) lost: u64,
}

impl Notices {
    pub(crate) fn with_capacity(capacity: usize) -> Self {
        Notices {
            ring: vec![None; capacity.max(1)].into(),
            first: 0,
            len: 0,
            lost: 0,
        }
    }

    pub(crate) fn push(&mut self, notice: Notice) {
        if self.len == self.ring.len() {
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
