//! Parts of drivers that do not depend on the protocol: the queue of states to the cycle, and reading of received bytes.

use rtrb::Consumer;

/// Capacity of the queues between the cycle and the thread of a driver, in set-points or states.
pub(crate) const QUEUE: usize = 256;

/// Returns the newest entry of a queue and removes all; `None` if the queue is empty. Neither waits nor allocates.
pub(crate) fn newest<T>(queue: &mut Consumer<T>) -> Option<T> {
    let mut newest = None;
    // Bounded: the thread cannot add as fast as the queue is emptied.
    for _ in 0..QUEUE {
        match queue.pop() {
            Ok(entry) => newest = Some(entry),
            Err(_) => break,
        }
    }
    newest
}

/// Reader of the fields of received bytes; each field is `None` if the bytes are too short.
pub(crate) struct Fields<'a>(pub(crate) &'a [u8]);

impl Fields<'_> {
    /// Removes the next `N` bytes and returns them.
    pub(crate) fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*first)
    }
}
