//! Evaluation of facts about commands for the conditions of rules.

use crate::command::{Cause, Command, Ending};
use crate::commands::{Core, Entry};
use crate::condition::{Fact, Truth};
use crate::id::CommandId;
use crate::lifecycle::State;
use rpi_image::{Scalar, Type};

impl Core {
    /// Knowledge about a fact: its present value and its possible later values. A scheduled command that is not marked
    /// as live counts as one that never runs.
    pub(crate) fn know(&self, id: CommandId, fact: Fact) -> Truth {
        match self.find(id).and_then(|place| self.entries[place].as_ref()) {
            Some(entry) => entry.know(fact),
            None => Truth::NEVER,
        }
    }
}

impl Entry {
    pub(crate) fn know(&self, fact: Fact) -> Truth {
        if let Fact::Export(index) = fact {
            return self.know_export(index);
        }
        match &self.command.ending {
            Some(ending) => Truth::fixed(holds(fact, ending)),
            None if self.will_never_be(fact) => Truth::fixed(false),
            None => Truth::now(false),
        }
    }

    /// Final value of a fact when the command is removed. A command that never ran counts as not ended.
    pub(crate) fn last_word(&self, fact: Fact) -> Option<bool> {
        match (fact, &self.command.ending) {
            (Fact::Export(index), Some(_)) => self.command.exported(index),
            (Fact::Export(_), None) => None,
            (_, Some(ending)) => Some(holds(fact, ending)),
            (_, None) => Some(false),
        }
    }

    /// True if a fact about the end of the command can no longer become true.
    fn will_never_be(&self, fact: Fact) -> bool {
        match self.command.state {
            State::Scheduled => !self.live,
            State::Cancelling => fact == Fact::Regular,
            State::Rejected => true,
            _ => false,
        }
    }

    fn know_export(&self, index: u32) -> Truth {
        let value = self.command.exported(index);
        match self.command.state {
            State::Running | State::Cancelling => value.map_or(Truth::OPEN, Truth::now),
            State::Terminated => value.map_or(Truth::NEVER, Truth::fixed),
            State::Scheduled if !self.live => Truth::NEVER,
            _ => Truth::OPEN,
        }
    }
}

impl Command {
    /// Value of an exported Boolean at the end of the latest cycle. `None` before the first cycle, while the flow is
    /// absent, and for other types.
    #[must_use]
    pub fn exported(&self, index: u32) -> Option<bool> {
        *self.shown.get(index as usize)?
    }

    /// Stores the exported Booleans at the end of a cycle. Inputs set between two cycles therefore do not affect
    /// conditions before the next cycle.
    pub(crate) fn show(&mut self) {
        let exports = &self.machine.image().exports;
        for (shown, export) in self.shown.iter_mut().zip(exports) {
            if export.value.ty == Type::One(Scalar::Bool) {
                *shown = self.machine.value(export.value).map(|v| v[0] != 0);
            }
        }
    }
}

/// Whether a fact is true of a command with this ending.
pub(crate) fn holds(fact: Fact, ending: &Ending) -> bool {
    match fact {
        Fact::Export(_) => false,
        Fact::Ended => true,
        Fact::Regular => ending.is_regular(),
        Fact::Failed => ending.error != 0,
        Fact::Result(k) => ending.cause == Cause::Result(k as usize),
        Fact::Error(number) => ending.error == number,
    }
}
