//! Connection to the control core: requests go to the cycle, events come from it.

use rpi_runtime::control::{CommandId, Control, Event, Rejected, RuleId, Ticket};

use super::commands::Commands;
use super::owed::{Debt, Owed, Owing};
use super::pending::{Errand, PendingRequests, Then};
use super::record::Record;
use super::types::{Failure, Reply};

/// Entries of the request queue reserved for the server itself.
const RESERVED: usize = 1024;

/// The connection to the control core, with the requests that it has not answered and those that are not sent yet.
pub(crate) struct CoreLink {
    pub(super) control: Control,
    pending: PendingRequests,
    deferred: Owed,
}

impl CoreLink {
    /// Creates the connection.
    pub(super) fn new(control: Control) -> CoreLink {
        CoreLink {
            control,
            pending: PendingRequests::default(),
            deferred: Owed::default(),
        }
    }

    /// Returns the next event of the cycle.
    pub(super) fn poll(&mut self) -> Option<Event> {
        self.control.poll()
    }

    /// Registers what follows once the cycle has answered a request. If the request could not be sent, reports the
    /// error to `reply` and returns false.
    pub(super) fn asked(
        &mut self,
        ticket: Result<Ticket, Rejected>,
        then: Then,
        reply: Option<Reply>,
    ) -> bool {
        self.pending.track(ticket, then, reply)
    }

    /// Sends a request about a command.
    pub(super) fn ask(
        &mut self,
        commands: &Commands,
        name: &str,
        what: impl FnOnce(&mut Control, CommandId) -> Result<Ticket, Rejected>,
        reply: Reply,
    ) {
        match self.may_ask().and_then(|()| commands.core_id(name)) {
            Ok(id) => {
                let ticket = what(&mut self.control, id);
                self.asked(ticket, Then::Nothing, Some(reply));
            }
            Err(why) => reply(Err(why)),
        }
    }

    /// Returns the upper bound on the command's time per tick in nanoseconds, once it is loaded.
    pub(crate) fn bound_ns(&self, record: &Record) -> Option<u64> {
        Some(self.control.bound_ns(record.id?))
    }

    /// Removes the pending request with this ticket.
    pub(super) fn answered(&mut self, ticket: Ticket) -> Option<Errand> {
        self.pending.take(ticket)
    }

    /// Returns whether every request that was sent is answered.
    pub(super) fn has_answered_all(&self) -> bool {
        self.pending.is_empty()
    }

    /// Applies an operation to a command, as soon as the queue has room.
    pub(super) fn owe_by_id(&mut self, id: CommandId, debt: Debt) {
        self.owe_it(Owing::Command(id, debt));
    }

    /// Withdraws a rule, as soon as the queue has room.
    pub(super) fn owe_rule(&mut self, id: RuleId) {
        self.owe_it(Owing::Rule(id));
    }

    fn owe_it(&mut self, owing: Owing) {
        self.deferred.push(owing);
        self.pay();
    }

    /// Sends the deferred requests, as far as the queue has room.
    pub(super) fn pay(&mut self) {
        self.deferred.pay(&mut self.control, &mut self.pending);
    }

    /// Returns an error if only the reserved entries of the queue are free. Those are for deferred requests and running
    /// tasks.
    pub(super) fn may_ask(&self) -> Result<(), Failure> {
        match self.deferred.is_empty() && self.control.room() > RESERVED {
            true => Ok(()),
            false => Err(Failure::Busy),
        }
    }
}
