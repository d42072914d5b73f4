//! Deferred requests: requests to the cycle whose answers nobody waits for, such as cancelling and unloading the
//! commands of a disconnected client.
//!
//! They must not be lost when clients flood the request queue. Clients leave room for them, and a request that finds
//! the queue full is sent again later.

use std::collections::VecDeque;

use rpi_runtime::control::{CommandId, Rejected, RuleId, Why};

use super::{Desk, Failure, Then};

/// Deferred operation on a command.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Debt {
    /// Cancel it.
    Cancel,
    /// Abort it.
    Abort(Why),
    /// Unload it.
    Unload,
}

/// Entries of the request queue reserved for the server itself.
const RESERVED: usize = 1024;

/// Requests that have not been sent yet, oldest first.
#[derive(Default)]
pub(super) struct Owed(VecDeque<Owing>);

/// A deferred request.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Owing {
    Command(CommandId, Debt),
    /// Withdraw the rule.
    Rule(RuleId),
}

impl Desk {
    /// Applies an operation to a command in the table, as soon as the queue has room.
    pub(super) fn owe(&mut self, number: u64, debt: Debt) {
        if let Some(id) = self.commands.get(&number).and_then(|r| r.id) {
            self.owe_by_id(id, debt);
        }
    }

    pub(super) fn owe_by_id(&mut self, id: CommandId, debt: Debt) {
        self.owe_it(Owing::Command(id, debt));
    }

    /// Withdraws a rule, as soon as the queue has room.
    pub(super) fn owe_rule(&mut self, id: RuleId) {
        self.owe_it(Owing::Rule(id));
    }

    fn owe_it(&mut self, owing: Owing) {
        if !self.owed.0.contains(&owing) {
            self.owed.0.push_back(owing);
        }
        self.pay();
    }

    /// Sends the deferred requests, as far as the queue has room.
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
            // Any other error means that the command or rule is gone, so nothing is left to do.
            self.asked(asked, Then::Nothing, None);
        }
    }

    /// Returns an error if only the reserved entries of the queue are free. Those are for deferred requests and running
    /// tasks.
    pub(super) fn may_ask(&self) -> Result<(), Failure> {
        match self.owed.0.is_empty() && self.control.room() > RESERVED {
            true => Ok(()),
            false => Err(Failure::Busy),
        }
    }
}
