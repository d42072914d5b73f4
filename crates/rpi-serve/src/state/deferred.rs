//! Deferred requests: requests to the cycle whose answers nobody waits for, such as cancelling and unloading the
//! commands of a disconnected client.
//!
//! They must not be lost when clients flood the request queue. Clients leave room for them, and a request that finds
//! the queue full is sent again later.

use std::collections::VecDeque;

use rpi_runtime::control::{AbortReason, CommandId, Control, RequestError, RuleId};

use super::pending::{OnAnswer, PendingRequests};

/// Operation on a command that is sent to the core once the queue has room.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum CommandOp {
    /// Cancels the command.
    Cancel,
    /// Aborts the command; the reason is reported to clients.
    Abort(AbortReason),
    /// Removes the command from the core's table.
    Unload,
}

/// Request to the core that waits for room in the request queue.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum DeferredOp {
    Command(CommandId, CommandOp),
    /// Withdraws the rule with this id, so that it cannot fire.
    Rule(RuleId),
}

/// Requests that have not been sent yet, oldest first. No request is in the queue twice.
#[derive(Default)]
pub(super) struct DeferredOps(VecDeque<DeferredOp>);

impl DeferredOps {
    /// Adds a request, unless the same request is in the queue already.
    pub(super) fn push(&mut self, deferred: DeferredOp) {
        if !self.0.contains(&deferred) {
            self.0.push_back(deferred);
        }
    }

    /// Sends requests, oldest first, until none is left or the request queue of the cycle is full. Sent requests are
    /// added to `pending`.
    pub(super) fn send_deferred(&mut self, control: &mut Control, pending: &mut PendingRequests) {
        while let Some(deferred) = self.0.front().copied() {
            let request = match deferred {
                DeferredOp::Command(id, CommandOp::Cancel) => control.cancel(id),
                DeferredOp::Command(id, CommandOp::Abort(why)) => control.abort(id, why),
                DeferredOp::Command(id, CommandOp::Unload) => control.unload(id),
                DeferredOp::Rule(id) => control.withdraw(id),
            };
            if request == Err(RequestError::QueueFull) {
                return;
            }
            self.0.pop_front();
            // Any other error means that the command or rule is gone, so nothing is left to do.
            pending.track(request, OnAnswer::Nothing, None);
        }
    }

    /// Returns the number of requests that are not sent yet.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns whether no request waits to be sent.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}
