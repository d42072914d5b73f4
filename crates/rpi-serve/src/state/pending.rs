//! Requests to the cycle that are not answered yet, and what follows each answer.

use std::collections::BTreeMap;

use rpi_runtime::control::{RequestError, RuleId, Ticket};

use super::types::{ApiError, DeviceInfo, Reply};

/// A request to the cycle that is not answered yet.
pub(super) struct PendingRequest {
    pub(super) then: OnAnswer,
    pub(super) reply: Option<Reply>,
}

/// Action after a request was carried out.
pub(super) enum OnAnswer {
    Nothing,
    CommandInserted(u64),
    RuleMade(RuleId),
    /// A command for a single cycle was started.
    Eval(u64),
    DeviceAdded(DeviceInfo),
    DeviceRemoved(String),
    /// All requests made before an emergency stop were carried out.
    Stopped,
}

/// The pending requests by ticket. Each one is removed by exactly one answer.
#[derive(Default)]
pub(super) struct PendingRequests(BTreeMap<Ticket, PendingRequest>);

impl PendingRequests {
    /// Registers what follows once the cycle has answered a request. If the request could not be sent, reports the
    /// error to `reply` and returns false.
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

    /// Removes the request with this ticket.
    pub(super) fn take(&mut self, ticket: Ticket) -> Option<PendingRequest> {
        self.0.remove(&ticket)
    }

    /// Returns whether every request was answered.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// Sends a result to its receiver, if there is one.
pub(super) fn answer(reply: Option<Reply>, result: Result<String, ApiError>) {
    if let Some(reply) = reply {
        reply(result);
    }
}
