//! Evaluation of facts about commands for the conditions of rules.

use crate::command::{Cause, Command, Ending};
use crate::command_table::Entry;
use crate::condition::{Fact, Truth};
use crate::lifecycle::CommandState;
use rpi_image::{Scalar, Type};

impl Entry {
    pub(crate) fn fact_truth(&self, fact: Fact) -> Truth {
        if let Fact::Export(index) = fact {
            return self.export_truth(index);
        }
        match &self.command.ending {
            Some(ending) => Truth::fixed(fact_holds(fact, ending)),
            None if self.can_never_hold(fact) => Truth::fixed(false),
            None => Truth::changeable(false),
        }
    }

    /// Returns the value of a fact about the command at its removal; `None` if the value is not known. A command that
    /// never ran counts as not ended.
    pub(crate) fn final_value(&self, fact: Fact) -> Option<bool> {
        match (fact, &self.command.ending) {
            (Fact::Export(index), Some(_)) => self.command.exported(index),
            (Fact::Export(_), None) => None,
            (_, Some(ending)) => Some(fact_holds(fact, ending)),
            (_, None) => Some(false),
        }
    }

    /// True if a fact about the end of the command can no longer become true, for example because the command will
    /// never run.
    fn can_never_hold(&self, fact: Fact) -> bool {
        match self.command.state {
            CommandState::Scheduled => !self.live,
            CommandState::Cancelling => fact == Fact::Regular,
            CommandState::Rejected => true,
            _ => false,
        }
    }

    fn export_truth(&self, index: u32) -> Truth {
        let value = self.command.exported(index);
        match self.command.state {
            CommandState::Running | CommandState::Cancelling => {
                value.map_or(Truth::UNKNOWN, Truth::changeable)
            }
            CommandState::Terminated => value.map_or(Truth::UNKNOWN_FOREVER, Truth::fixed),
            CommandState::Scheduled if !self.live => Truth::UNKNOWN_FOREVER,
            _ => Truth::UNKNOWN,
        }
    }
}

impl Command {
    /// Returns the value of the exported Boolean flow with this index at the end of the latest cycle. `None` before the
    /// first cycle, while the flow is absent, and for flows of other types.
    #[must_use]
    pub fn exported(&self, index: u32) -> Option<bool> {
        *self.exported_values.get(index as usize)?
    }

    /// Stores the exported Boolean flows at the end of a cycle. Conditions of rules read only these values, so an input
    /// that is set between two cycles does not affect them before the next cycle.
    pub(crate) fn latch_exports(&mut self) {
        let exports = &self.instance.image().exports;
        for (shown, export) in self.exported_values.iter_mut().zip(exports) {
            if export.value.ty == Type::Scalar(Scalar::Bool) {
                *shown = self.instance.value(export.value).map(|v| v[0] != 0);
            }
        }
    }
}

/// True if a fact holds for a command that has ended with `ending`; false for facts about exports.
pub(crate) fn fact_holds(fact: Fact, ending: &Ending) -> bool {
    match fact {
        Fact::Export(_) => false,
        Fact::Ended => true,
        Fact::Regular => ending.is_regular(),
        Fact::Failed => ending.error != 0,
        Fact::Result(k) => ending.cause == Cause::Result(k as usize),
        Fact::Error(number) => ending.error == number,
    }
}
