//! Host side of a control core whose requests are given by a recording.

use super::event::{Event, Ticket};
use super::queue::{HostQueues, Request};

/// Host side of a control core that repeats recorded requests, without admission control. The caller chooses the
/// numbers of tickets, commands and rules.
pub struct RawControl<T> {
    ends: HostQueues<T>,
}

impl<T> RawControl<T> {
    pub(super) fn new(ends: HostQueues<T>) -> RawControl<T> {
        RawControl { ends }
    }

    /// Sends a request under this ticket to the core. Returns false if the queue of requests is full.
    pub fn request(&mut self, ticket: Ticket, request: Request<T>) -> bool {
        self.ends.requests.push((ticket, request)).is_ok()
    }

    /// Returns the next event of the core; `None` if there is none now.
    pub fn poll(&mut self) -> Option<Event> {
        self.ends.events.pop().ok()
    }

    /// Frees all objects that the cycle no longer uses.
    pub fn free(&mut self) {
        while self.ends.released.pop().is_ok() {}
    }
}
