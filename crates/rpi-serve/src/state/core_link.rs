//! Connection to the control core: requests go to the cycle, events come from it.

use rpi_runtime::control::{CommandId, Control, Event, RequestError, RuleId, Ticket};

use super::commands::Commands;
use super::deferred::{CommandOp, DeferredOp, DeferredOps};
use super::pending::{OnAnswer, PendingRequest, PendingRequests};
use super::record::CommandRecord;
use super::types::{ApiError, Reply};

/// Entries of the request queue reserved for the server itself.
const RESERVED_ENTRIES: usize = 1024;

/// Connection of the server state to the control core, with the requests that the core has not answered and those that
/// are not sent yet.
pub(crate) struct CoreLink {
    pub(super) control: Control,
    pending: PendingRequests,
    deferred: DeferredOps,
}

impl CoreLink {
    /// Creates the connection.
    pub(super) fn new(control: Control) -> CoreLink {
        CoreLink {
            control,
            pending: PendingRequests::default(),
            deferred: DeferredOps::default(),
        }
    }

    /// Returns the next event of the core, if any.
    pub(super) fn poll(&mut self) -> Option<Event> {
        self.control.poll()
    }

    /// Registers the action that follows once the core has answered a request. If the request could not be sent,
    /// reports the error to `reply` and returns false.
    pub(super) fn track_request(
        &mut self,
        ticket: Result<Ticket, RequestError>,
        then: OnAnswer,
        reply: Option<Reply>,
    ) -> bool {
        self.pending.track(ticket, then, reply)
    }

    /// Sends a request about a command to the core.
    pub(super) fn send_request(
        &mut self,
        commands: &Commands,
        name: &str,
        what: impl FnOnce(&mut Control, CommandId) -> Result<Ticket, RequestError>,
        reply: Reply,
    ) {
        match self
            .ensure_queue_space()
            .and_then(|()| commands.command_id(name))
        {
            Ok(id) => {
                let ticket = what(&mut self.control, id);
                self.track_request(ticket, OnAnswer::Nothing, Some(reply));
            }
            Err(why) => reply(Err(why)),
        }
    }

    /// Returns the upper bound on the command's time per tick in nanoseconds, once it is loaded.
    pub(crate) fn bound_ns(&self, record: &CommandRecord) -> Option<u64> {
        Some(self.control.bound_ns(record.id?))
    }

    /// Removes the pending request with this ticket.
    pub(super) fn take_answered(&mut self, ticket: Ticket) -> Option<PendingRequest> {
        self.pending.take(ticket)
    }

    /// Returns whether every request that was sent is answered.
    pub(super) fn has_answered_all(&self) -> bool {
        self.pending.is_empty()
    }

    /// Sends an operation on a command to the core as soon as the queue has room.
    pub(super) fn defer_by_id(&mut self, id: CommandId, op: CommandOp) {
        self.push_deferred(DeferredOp::Command(id, op));
    }

    /// Sends the withdrawal of a rule to the core as soon as the queue has room.
    pub(super) fn defer_withdrawal(&mut self, id: RuleId) {
        self.push_deferred(DeferredOp::Rule(id));
    }

    fn push_deferred(&mut self, deferred: DeferredOp) {
        self.deferred.push(deferred);
        self.send_deferred();
    }

    /// Sends the deferred requests, as far as the queue has room.
    pub(super) fn send_deferred(&mut self) {
        self.deferred
            .send_deferred(&mut self.control, &mut self.pending);
    }

    /// Returns an error if only the reserved entries of the queue are free. Those are for deferred requests and running
    /// tasks.
    pub(super) fn ensure_queue_space(&self) -> Result<(), ApiError> {
        match self.deferred.is_empty() && self.control.free_requests() > RESERVED_ENTRIES {
            true => Ok(()),
            false => Err(ApiError::QueueFull),
        }
    }
}
