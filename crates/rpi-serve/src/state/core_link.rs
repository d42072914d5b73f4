//! Connection to the control core: requests go to the cycle, events come from it.

use std::collections::BTreeSet;

use rpi_runtime::control::{CommandId, Control, Event, RequestError, RuleId, Ticket};

use super::commands::Commands;
use super::deferred::{CommandOp, DeferredOp, DeferredOps};
use super::pending::{OnAnswer, PendingRequest, PendingRequests};
use super::record::CommandRecord;
use super::types::{ApiError, Reply};

/// Number of entries of the queue to the control core that client requests leave free for requests of the server
/// itself.
const RESERVED_ENTRIES: usize = 1024;

/// Connection of the server state to the control core. It also has the requests that the core has not answered and
/// those that wait for room in the request queue.
pub(crate) struct CoreLink {
    pub(super) control: Control,
    /// Number of requests that fit into the queue to the cycle.
    capacity: usize,
    pending: PendingRequests,
    deferred: DeferredOps,
    /// Resources (actuators) that must take their safe values.
    released_outputs: BTreeSet<u32>,
}

impl CoreLink {
    /// Creates the connection from the handle that controls the core.
    pub(super) fn new(control: Control) -> CoreLink {
        CoreLink {
            // Nothing was sent yet, so all of the queue is free.
            capacity: control.free_requests(),
            control,
            pending: PendingRequests::default(),
            deferred: DeferredOps::default(),
            released_outputs: BTreeSet::new(),
        }
    }

    /// Requests that these resources (actuators) take their safe values, unless a command holds them.
    pub(super) fn make_safe(&mut self, resources: BTreeSet<u32>) {
        self.released_outputs.extend(resources);
        if self.released_outputs.is_empty() {
            return;
        }
        let resources: Vec<u32> = self.released_outputs.iter().copied().collect();
        let ticket = self.control.make_safe(resources);
        // Without room in the queue, the next update tries again.
        if self.track_request(ticket, OnAnswer::Nothing, None) {
            self.released_outputs.clear();
        }
    }

    /// Returns the next event of the core; `None` if there is none now.
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

    /// Sends a request about the command with this name to the core. `what` makes the request. The core's answer, or an
    /// error, goes to `reply`.
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

    /// Returns the upper bound on the time of one cycle of the command in nanoseconds; `None` before the command is
    /// loaded.
    pub(crate) fn bound_ns(&self, record: &CommandRecord) -> Option<u64> {
        Some(self.control.bound_ns(record.id?))
    }

    /// Removes and returns the pending request with this ticket; `None` if there is none.
    pub(super) fn take_answered(&mut self, ticket: Ticket) -> Option<PendingRequest> {
        self.pending.take(ticket)
    }

    /// Returns the name of each queue of requests with the number of its entries: requests that the cycle has not taken,
    /// requests that it has not answered, and requests of the server that wait for room.
    pub(crate) fn queue_depths(&self) -> [(&'static str, usize); 3] {
        let not_taken = self.capacity.saturating_sub(self.control.free_requests());
        [
            ("cycle", not_taken),
            ("unanswered", self.pending.len()),
            ("deferred", self.deferred.len()),
        ]
    }

    /// Returns whether the core has answered every request that was sent.
    pub(super) fn has_answered_all(&self) -> bool {
        self.pending.is_empty()
    }

    /// Sends an operation on the command with this id to the core as soon as the request queue has room.
    pub(super) fn defer_by_id(&mut self, id: CommandId, op: CommandOp) {
        self.push_deferred(DeferredOp::Command(id, op));
    }

    /// Sends the withdrawal of a rule to the core as soon as the request queue has room.
    pub(super) fn defer_withdrawal(&mut self, id: RuleId) {
        self.push_deferred(DeferredOp::Rule(id));
    }

    fn push_deferred(&mut self, deferred: DeferredOp) {
        self.deferred.push(deferred);
        self.send_deferred();
    }

    /// Sends deferred requests until none is left or the request queue is full.
    pub(super) fn send_deferred(&mut self) {
        self.deferred
            .send_deferred(&mut self.control, &mut self.pending);
        self.make_safe(BTreeSet::new());
    }

    /// Returns an error if only the reserved entries of the request queue are free. The reserved entries are for
    /// deferred requests and running tasks.
    pub(super) fn ensure_queue_space(&self) -> Result<(), ApiError> {
        match self.deferred.is_empty() && self.control.free_requests() > RESERVED_ENTRIES {
            true => Ok(()),
            false => Err(ApiError::QueueFull),
        }
    }
}
