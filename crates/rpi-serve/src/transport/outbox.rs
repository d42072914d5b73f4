//! Bounded queue of outgoing messages of a client. Senders never block.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::Duration;

use super::framing::{Outgoing, OutgoingMessage};
use super::memory_pool::ConnectionMemory;
use crate::limits::Limits;

/// Sender side of the queue of messages to a client. A client that does not read its messages is disconnected once the
/// queue is full.
#[derive(Clone)]
pub(crate) struct Outbox {
    messages: SyncSender<QueuedMessage>,
    closed: Arc<AtomicBool>,
    /// Memory of the messages that are queued for the client.
    memory: Arc<ConnectionMemory>,
    /// Number of subscriptions that the client may still make.
    subscriptions_left: Arc<AtomicUsize>,
}

/// Sender of the messages of one subscription. Dropping it frees the client's quota for another subscription.
pub(crate) struct SubscriptionSender(Outbox);

/// Message to a client, with the memory that is reserved for it.
pub(crate) struct QueuedMessage {
    text: String,
    space: QueueSpace,
}

/// Memory that is reserved for a message to a client. Dropping it releases the memory.
pub(crate) struct QueueSpace {
    memory: Arc<ConnectionMemory>,
    bytes: usize,
}

/// Receiver side of the queue of messages to a client, owned by the client's connection.
pub(crate) struct OutboxReceiver {
    messages: Receiver<QueuedMessage>,
    closed: Arc<AtomicBool>,
}

/// Creates the queue of messages to a client: its sender and its receiver side.
pub(crate) fn outbox(limits: &Limits, memory: ConnectionMemory) -> (Outbox, OutboxReceiver) {
    let (sender, messages) = sync_channel(limits.queued_messages);
    let closed = Arc::new(AtomicBool::new(false));
    let outbox = Outbox {
        messages: sender,
        closed: Arc::clone(&closed),
        memory: Arc::new(memory),
        subscriptions_left: Arc::new(AtomicUsize::new(limits.subscriptions)),
    };
    (outbox, OutboxReceiver { messages, closed })
}

impl QueuedMessage {
    /// Splits the message into its text and its memory, which must be kept until the text is sent.
    pub(crate) fn into_parts(self) -> (String, QueueSpace) {
        (self.text, self.space)
    }
}

impl QueueSpace {
    /// Reserves `more` bytes. Returns false, and reserves nothing, if the client has no memory left.
    pub(crate) fn grow(&mut self, more: usize) -> bool {
        let is_granted = self.memory.reserve(more);
        if is_granted {
            self.bytes += more;
        }
        is_granted
    }
}

impl Drop for QueueSpace {
    fn drop(&mut self) {
        self.memory.release(self.bytes);
    }
}

impl Outbox {
    /// Queues a message to the client. Returns false if the client is disconnected. A full queue disconnects the
    /// client.
    pub(crate) fn queue(&self, text: String) -> bool {
        let mut space = self.space();
        if !space.grow(text.len()) {
            self.close();
        }
        self.queue_in(text, space)
    }

    /// Queues a message for which memory is reserved, as [`Outbox::queue`].
    pub(crate) fn queue_in(&self, text: String, space: QueueSpace) -> bool {
        if self.closed.load(Ordering::Relaxed) {
            return false;
        }
        // A client that does not read is disconnected. Waiting would block the thread that serves all clients, and
        // without single messages the client would be wrong about the state.
        let put = self
            .messages
            .try_send(QueuedMessage { text, space })
            .is_ok();
        if !put {
            self.close();
        }
        put
    }

    /// Creates a space for a message to the client, in which no memory is reserved yet.
    pub(crate) fn space(&self) -> QueueSpace {
        QueueSpace {
            memory: Arc::clone(&self.memory),
            bytes: 0,
        }
    }

    /// Marks the client as disconnected.
    pub(crate) fn close(&self) {
        self.closed.store(true, Ordering::Relaxed);
    }

    /// Returns how many further subscriptions the client may have.
    #[cfg(test)]
    pub(crate) fn subscriptions_left(&self) -> usize {
        self.subscriptions_left.load(Ordering::Relaxed)
    }

    /// Reserves a sender for a subscription; `None` if the client has the maximum number of subscriptions.
    pub(crate) fn subscription_sender(&self) -> Option<SubscriptionSender> {
        take(&self.subscriptions_left, 1).then(|| SubscriptionSender(self.clone()))
    }
}

/// Subtracts a number from what is left of a quota. Returns false, and subtracts nothing, if less is left.
fn take(left: &AtomicUsize, number: usize) -> bool {
    let less = |left: usize| left.checked_sub(number);
    left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less)
        .is_ok()
}

impl SubscriptionSender {
    /// Queues a message, as [`Outbox::queue`]. Returns false if the client is disconnected.
    pub(crate) fn send(&self, message: String) -> bool {
        self.0.queue(message)
    }

    /// Returns whether the client is still connected.
    pub(crate) fn is_connected(&self) -> bool {
        !self.0.closed.load(Ordering::Relaxed)
    }
}

impl Drop for SubscriptionSender {
    fn drop(&mut self) {
        self.0.subscriptions_left.fetch_add(1, Ordering::Relaxed);
    }
}

impl OutboxReceiver {
    /// Waits for the next message to the client, for at most `wait`; `None` if there is none.
    pub(crate) fn receive(&self, wait: Duration) -> Option<QueuedMessage> {
        match wait.is_zero() {
            true => self.messages.try_recv().ok(),
            false => self.messages.recv_timeout(wait).ok(),
        }
    }

    /// Returns whether the client was marked as disconnected, so that its connection must end.
    pub(crate) fn is_closed(&self) -> bool {
        self.closed.load(Ordering::Relaxed)
    }
}

impl Outgoing for OutboxReceiver {
    fn next_message(&self, wait: Duration) -> Option<OutgoingMessage> {
        let (text, space) = self.receive(wait)?.into_parts();
        Some(OutgoingMessage::Text(text, Some(space)))
    }

    fn is_closed(&self) -> bool {
        OutboxReceiver::is_closed(self)
    }
}

impl Drop for OutboxReceiver {
    fn drop(&mut self) {
        self.closed.store(true, Ordering::Relaxed);
    }
}
