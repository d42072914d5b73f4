//! Bounded queue of outgoing messages of a client. Senders never block.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// Sender side of the queue. A client that does not read its messages is disconnected once the queue is full.
#[derive(Clone)]
pub(crate) struct Outbox {
    messages: SyncSender<String>,
    over: Arc<AtomicBool>,
    /// Number of subscriptions that the client may still make.
    left: Arc<AtomicUsize>,
}

/// Sender for one subscription. Dropping it frees the subscription's place.
pub(crate) struct Post(Outbox);

/// Receiver side of the queue, owned by the connection.
pub(crate) struct Outgoing {
    pub(crate) messages: Receiver<String>,
    over: Arc<AtomicBool>,
}

/// Creates a queue of at most `most` messages, for a client with at most `watches` subscriptions.
pub(crate) fn outbox(most: usize, watches: usize) -> (Outbox, Outgoing) {
    let (sender, messages) = sync_channel(most);
    let over = Arc::new(AtomicBool::new(false));
    let outbox = Outbox {
        messages: sender,
        over: Arc::clone(&over),
        left: Arc::new(AtomicUsize::new(watches)),
    };
    (outbox, Outgoing { messages, over })
}

impl Outbox {
    /// Queues a message. Returns false if the client is disconnected.
    pub(crate) fn put(&self, message: String) -> bool {
        if self.over.load(Ordering::Relaxed) {
            return false;
        }
        let put = self.messages.try_send(message).is_ok();
        if !put {
            self.end();
        }
        put
    }

    /// Marks the client as disconnected.
    pub(crate) fn end(&self) {
        self.over.store(true, Ordering::Relaxed);
    }

    /// Reserves a sender for a subscription; `None` if the client has too many.
    pub(crate) fn post(&self) -> Option<Post> {
        let one_less = |left: usize| left.checked_sub(1);
        let (set, get) = (Ordering::Relaxed, Ordering::Relaxed);
        let taken = self.left.fetch_update(set, get, one_less);
        taken.ok().map(|_| Post(self.clone()))
    }
}

impl Post {
    /// Queues a message, as [`Outbox::put`].
    pub(crate) fn put(&self, message: String) -> bool {
        self.0.put(message)
    }

    /// Returns whether the client is still connected.
    pub(crate) fn is_heard(&self) -> bool {
        !self.0.over.load(Ordering::Relaxed)
    }
}

impl Drop for Post {
    fn drop(&mut self) {
        self.0.left.fetch_add(1, Ordering::Relaxed);
    }
}

impl Outgoing {
    /// Returns whether the client is to be disconnected.
    pub(crate) fn is_over(&self) -> bool {
        self.over.load(Ordering::Relaxed)
    }
}

impl Drop for Outgoing {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
    }
}
