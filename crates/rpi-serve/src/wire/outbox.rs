//! What waits to be sent to a client: bounded, and nobody waits to put something in.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// Where messages for a client are put. A client that does not take them is given up once there is no room left.
#[derive(Clone)]
pub(crate) struct Outbox {
    messages: SyncSender<String>,
    over: Arc<AtomicBool>,
}

/// The connection's end.
pub(crate) struct Outgoing {
    pub(crate) messages: Receiver<String>,
    over: Arc<AtomicBool>,
}

pub(crate) fn outbox(most: usize) -> (Outbox, Outgoing) {
    let (sender, messages) = sync_channel(most);
    let over = Arc::new(AtomicBool::new(false));
    let outbox = Outbox {
        messages: sender,
        over: Arc::clone(&over),
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
            self.over.store(true, Ordering::Relaxed);
        }
        put
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
