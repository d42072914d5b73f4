//! What waits to be sent to a client: bounded, and nobody waits to put something in.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// Where messages for a client are put. A client that does not take them is given up once there is no room left.
#[derive(Clone)]
pub(crate) struct Outbox {
    messages: SyncSender<String>,
    over: Arc<AtomicBool>,
    /// Things that the client may watch yet.
    left: Arc<AtomicUsize>,
}

/// An outbox for what a client watches: one of a number of places, free again once it is dropped.
pub(crate) struct Post(Outbox);

/// The connection's end.
pub(crate) struct Outgoing {
    pub(crate) messages: Receiver<String>,
    over: Arc<AtomicBool>,
}

/// An outbox for so many messages, to a client that may watch so many things.
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
    /// Puts a message in; false if the client is gone or given up.
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

    /// Nobody listens any more.
    pub(crate) fn end(&self) {
        self.over.store(true, Ordering::Relaxed);
    }

    /// A place for something to be watched; none if the client watches too much already.
    pub(crate) fn post(&self) -> Option<Post> {
        let one_less = |left: usize| left.checked_sub(1);
        let (set, get) = (Ordering::Relaxed, Ordering::Relaxed);
        let taken = self.left.fetch_update(set, get, one_less);
        taken.ok().map(|_| Post(self.clone()))
    }
}

impl Post {
    /// As [`Outbox::put`].
    pub(crate) fn put(&self, message: String) -> bool {
        self.0.put(message)
    }

    /// Whether somebody listens still.
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
    /// True once the client is given up.
    pub(crate) fn is_over(&self) -> bool {
        self.over.load(Ordering::Relaxed)
    }
}

impl Drop for Outgoing {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
    }
}
