//! Bounded queue of outgoing messages of a client. Senders never block.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// Sender side of the queue of messages to a client. A client that does not read its messages is disconnected once the
/// queue is full.
#[derive(Clone)]
pub(crate) struct Outbox {
    messages: SyncSender<String>,
    closed: Arc<AtomicBool>,
    /// Number of subscriptions that the client may still make.
    subscriptions_left: Arc<AtomicUsize>,
}

/// Sender of the messages of one subscription. Dropping it allows the client another subscription.
pub(crate) struct SubscriptionSender(Outbox);

/// Receiver side of the queue of messages to a client, owned by the connection.
pub(crate) struct OutboxReceiver {
    pub(crate) messages: Receiver<String>,
    closed: Arc<AtomicBool>,
}

/// Creates a queue of at most `most` messages, for a client with at most `watches` subscriptions.
pub(crate) fn outbox(most: usize, watches: usize) -> (Outbox, OutboxReceiver) {
    let (sender, messages) = sync_channel(most);
    let over = Arc::new(AtomicBool::new(false));
    let outbox = Outbox {
        messages: sender,
        closed: Arc::clone(&over),
        subscriptions_left: Arc::new(AtomicUsize::new(watches)),
    };
    (
        outbox,
        OutboxReceiver {
            messages,
            closed: over,
        },
    )
}

impl Outbox {
    /// Queues a message. Returns false if the client is disconnected.
    pub(crate) fn put_device(&self, message: String) -> bool {
        if self.closed.load(Ordering::Relaxed) {
            return false;
        }
        // A client that does not read is disconnected. Waiting would block the thread that serves all clients, and
        // without single messages the client would be wrong about the state.
        let put = self.messages.try_send(message).is_ok();
        if !put {
            self.close();
        }
        put
    }

    /// Marks the client as disconnected.
    pub(crate) fn close(&self) {
        self.closed.store(true, Ordering::Relaxed);
    }

    /// Reserves a sender for a subscription; `None` if the client has too many.
    pub(crate) fn subscription_sender(&self) -> Option<SubscriptionSender> {
        let one_less = |left: usize| left.checked_sub(1);
        let (set, get) = (Ordering::Relaxed, Ordering::Relaxed);
        let taken = self.subscriptions_left.fetch_update(set, get, one_less);
        taken.ok().map(|_| SubscriptionSender(self.clone()))
    }
}

impl SubscriptionSender {
    /// Queues a message, as [`Outbox::put`]. Returns false if the client is disconnected.
    pub(crate) fn send(&self, message: String) -> bool {
        self.0.put_device(message)
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
    /// Returns whether the client is to be disconnected.
    pub(crate) fn is_closed(&self) -> bool {
        self.closed.load(Ordering::Relaxed)
    }
}

impl Drop for OutboxReceiver {
    fn drop(&mut self) {
        self.closed.store(true, Ordering::Relaxed);
    }
}
