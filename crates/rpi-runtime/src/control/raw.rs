//! Host side of a control core whose requests are given by a recording.

use super::event::{Event, Ticket};
use super::queue::{HostQueues, Request};

/// Access of the host to a control core without admission control. The caller chooses the numbers of tickets, commands
/// and rules.
pub struct RawControl<T> {
    ends: HostQueues<T>,
}

impl<T> RawControl<T> {
    pub(super) fn new(ends: HostQueues<T>) -> RawControl<T> {
        RawControl { ends }
    }

    /// Sends a request. Returns false if the queue of requests is full.
    pub fn request(&mut self, ticket: Ticket, request: Request<T>) -> bool {
        self.ends.requests.push((ticket, request)).is_ok()
    }

    /// Returns the next event, if any.
    pub fn poll(&mut self) -> Option<Event> {
        self.ends.events.pop().ok()
    }

    /// Frees all objects that the cycle has released.
    pub fn free(&mut self) {
        while self.ends.released.pop().is_ok() {}
    }
}
