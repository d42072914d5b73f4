//! Bounded queue of outgoing messages of a client. Senders never block.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::Duration;

use crate::limits::Limits;

/// Sender side of the queue of messages to a client. A client that does not read its messages is disconnected once the
/// queue is full.
#[derive(Clone)]
pub(crate) struct Outbox {
    messages: SyncSender<String>,
    closed: Arc<AtomicBool>,
    /// Number of bytes that may still be queued for the client.
    bytes_left: Arc<AtomicUsize>,
    /// Number of subscriptions that the client may still make.
    subscriptions_left: Arc<AtomicUsize>,
}

/// Sender of the messages of one subscription. Dropping it frees the client's quota for another subscription.
pub(crate) struct SubscriptionSender(Outbox);

/// Receiver side of the queue of messages to a client, owned by the client's connection.
pub(crate) struct OutboxReceiver {
    messages: Receiver<String>,
    closed: Arc<AtomicBool>,
    bytes_left: Arc<AtomicUsize>,
}

/// Creates the queue of messages to a client: its sender and its receiver side.
pub(crate) fn outbox(limits: &Limits) -> (Outbox, OutboxReceiver) {
    let (sender, messages) = sync_channel(limits.queued_messages);
    let over = Arc::new(AtomicBool::new(false));
    let bytes_left = Arc::new(AtomicUsize::new(limits.queued_bytes));
    let outbox = Outbox {
        messages: sender,
        closed: Arc::clone(&over),
        bytes_left: Arc::clone(&bytes_left),
        subscriptions_left: Arc::new(AtomicUsize::new(limits.subscriptions)),
    };
    (
        outbox,
        OutboxReceiver {
            messages,
            closed: over,
            bytes_left,
        },
    )
}

impl Outbox {
    /// Queues a message to the client. Returns false if the client is disconnected. A full queue disconnects the
    /// client.
    pub(crate) fn queue(&self, message: String) -> bool {
        if self.closed.load(Ordering::Relaxed) {
            return false;
        }
        // A client that does not read is disconnected. Waiting would block the thread that serves all clients, and
        // without single messages the client would be wrong about the state.
        let put = take(&self.bytes_left, message.len()) && self.messages.try_send(message).is_ok();
        if !put {
            self.close();
        }
        put
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
    pub(crate) fn receive(&self, wait: Duration) -> Option<String> {
        let message = match wait.is_zero() {
            true => self.messages.try_recv().ok(),
            false => self.messages.recv_timeout(wait).ok(),
        };
        let message = message?;
        self.bytes_left.fetch_add(message.len(), Ordering::Relaxed);
        Some(message)
    }

    /// Returns whether the client was marked as disconnected, so that its connection must end.
    pub(crate) fn is_closed(&self) -> bool {
        self.closed.load(Ordering::Relaxed)
    }
}

impl Drop for OutboxReceiver {
    fn drop(&mut self) {
        self.closed.store(true, Ordering::Relaxed);
    }
}
