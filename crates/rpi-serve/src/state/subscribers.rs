//! Subscribers to the changes of one object.

use super::types::{Subscriber, Update};

/// The subscribers to one object. A subscriber whose client has disconnected is removed at the next update.
#[derive(Default)]
pub(super) struct Subscribers(Vec<Box<dyn Subscriber>>);

impl Subscribers {
    /// Adds a subscriber without sending it an update.
    pub(super) fn push(&mut self, sink: Box<dyn Subscriber>) {
        self.0.push(sink);
    }

    /// Sends an update to a new subscriber and adds the subscriber to the list, unless its client has disconnected.
    pub(super) fn add(&mut self, mut sink: Box<dyn Subscriber>, update: &Update<'_>) {
        if sink.notify(update) {
            self.0.push(sink);
        }
    }

    /// Sends an update to all subscribers.
    pub(super) fn notify(&mut self, update: &Update<'_>) {
        self.0.retain_mut(|sink| sink.notify(update));
    }

    /// Removes the subscribers whose clients have disconnected, without sending an update.
    pub(super) fn remove_disconnected(&mut self) {
        self.0.retain(|sink| sink.is_connected());
    }

    /// Returns whether there is no subscriber.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the number of subscribers.
    #[cfg(test)]
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }
}
