//! One connection: messages of the client, and those that wait for it.

use std::time::Duration;

use super::hub::{ClientId, LiveHub};
use crate::transport::{ConnectionHandler, Outgoing, OutgoingMessage};

/// Client of the hub as a connection sees it. Dropping it removes the client.
pub(super) struct LiveConnection {
    pub(super) hub: LiveHub,
    pub(super) id: ClientId,
}

/// Handler of the messages of a client.
pub(super) struct LiveRequests<'c>(pub(super) &'c LiveConnection);

impl ConnectionHandler for LiveRequests<'_> {
    fn on_message(&mut self, text: &str) -> bool {
        self.0.hub.handle(self.0.id, text);
        true
    }
}

impl Outgoing for LiveConnection {
    /// Returns the next message at once: answers are in the queue when the message of the client was handled.
    fn next_message(&self, _: Duration) -> Option<OutgoingMessage> {
        self.hub.next_message(self.id)
    }

    fn is_closed(&self) -> bool {
        self.hub.is_closed(self.id)
    }
}

impl Drop for LiveConnection {
    fn drop(&mut self) {
        self.hub.remove_client(self.id);
    }
}
