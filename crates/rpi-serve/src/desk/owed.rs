//! What the desk owes the cycle without anybody waiting for the answer: what a lost client runs is to end, what is over to be unloaded.
//!
//! None of it may be lost because others flood the queue: clients leave room for it, and what finds none all the same is asked for
//! again.

use std::collections::VecDeque;

use rpi_host::control::{CommandId, Rejected, RuleId, Why};

use super::{Desk, Failure, Then};

/// Something to be done to a command.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Debt {
    /// It is asked to end.
    Cancel,
    /// It ends by force.
    Abort(Why),
    /// It is no longer needed.
    Unload,
}

/// Requests that clients leave room for.
const RESERVED: usize = 1024;

/// What has found no room yet, in the order in which it came up.
#[derive(Default)]
pub(super) struct Owed(VecDeque<Owing>);

/// To whom something is to be done.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Owing {
    Command(CommandId, Debt),
    /// It is dropped.
    Rule(RuleId),
}

impl Desk {
    /// Does something to a command that is in the table, as soon as there is room to ask for it.
    pub(super) fn owe(&mut self, number: u64, debt: Debt) {
        if let Some(id) = self.commands.get(&number).and_then(|r| r.id) {
            self.owe_by_id(id, debt);
        }
    }

    pub(super) fn owe_by_id(&mut self, id: CommandId, debt: Debt) {
        self.owe_it(Owing::Command(id, debt));
    }

    /// Drops a rule as soon as there is room to ask for it.
    pub(super) fn owe_rule(&mut self, id: RuleId) {
        self.owe_it(Owing::Rule(id));
    }

    fn owe_it(&mut self, owing: Owing) {
        if !self.owed.0.contains(&owing) {
            self.owed.0.push_back(owing);
        }
        self.pay();
    }

    /// Asks for what is owed, as far as there is room.
    pub(super) fn pay(&mut self) {
        while let Some(owing) = self.owed.0.front().copied() {
            let asked = match owing {
                Owing::Command(id, Debt::Cancel) => self.control.cancel(id),
                Owing::Command(id, Debt::Abort(why)) => self.control.abort(id, why),
                Owing::Command(id, Debt::Unload) => self.control.unload(id),
                Owing::Rule(id) => self.control.withdraw(id),
            };
            if asked == Err(Rejected::Busy) {
                return;
            }
            self.owed.0.pop_front();
            // Who is gone meanwhile needs nothing any more.
            self.asked(asked, Then::Nothing, None);
        }
    }

    /// Fails while there is only room left for what the desk itself asks for: what is owed, and what tasks go on with.
    pub(super) fn may_ask(&self) -> Result<(), Failure> {
        match self.owed.0.is_empty() && self.control.room() > RESERVED {
            true => Ok(()),
            false => Err(Failure::Busy),
        }
    }
}
