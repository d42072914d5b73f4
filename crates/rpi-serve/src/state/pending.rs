//! Requests to the cycle that are not answered yet, and what follows each answer.

use std::collections::BTreeMap;

use rpi_runtime::control::{RequestError, RuleId, Ticket};

use super::types::{ApiError, DeviceInfo, Reply};

/// Request to the core that is not answered yet: the action that follows the answer, and the callback for the client.
pub(super) struct PendingRequest {
    pub(super) then: OnAnswer,
    pub(super) reply: Option<Reply>,
}

/// Action that follows when the core has carried out a request. Objects are given by number, id, description or name.
pub(super) enum OnAnswer {
    Nothing,
    CommandInserted(u64),
    RuleMade(RuleId),
    /// Reports the start of the command with this number, which evaluates a net for a single cycle.
    Eval(u64),
    DeviceAdded(DeviceInfo),
    DeviceRemoved(String),
    /// Clears the emergency stop flag of the cycle: all requests made before the stop were carried out.
    Stopped,
}

/// Requests to the core that are not answered yet, by ticket. Each one is removed by exactly one answer.
#[derive(Default)]
pub(super) struct PendingRequests(BTreeMap<Ticket, PendingRequest>);

impl PendingRequests {
    /// Registers the action that follows once the core has answered a request. If the request could not be sent,
    /// reports the error to `reply` and returns false.
    pub(super) fn track(
        &mut self,
        ticket: Result<Ticket, RequestError>,
        then: OnAnswer,
        reply: Option<Reply>,
    ) -> bool {
        match ticket {
            Ok(ticket) => {
                self.0.insert(ticket, PendingRequest { then, reply });
                true
            }
            Err(why) => {
                answer(reply, Err(why.into()));
                false
            }
        }
    }

    /// Removes and returns the request with this ticket; `None` if there is none.
    pub(super) fn take(&mut self, ticket: Ticket) -> Option<PendingRequest> {
        self.0.remove(&ticket)
    }

    /// Returns the number of requests that are not answered yet.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns whether the core has answered every request.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// Sends a result to the callback that waits for it, if there is one.
pub(super) fn answer(reply: Option<Reply>, result: Result<String, ApiError>) {
    if let Some(reply) = reply {
        reply(result);
    }
}
