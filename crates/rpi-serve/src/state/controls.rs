//! Override and pause of all motions: what an operator sets for the whole core.

use rpi_core::MotionControls;

use super::subscribers::Subscribers;
use super::types::{Subscriber, Update};

/// Speed override and pause of all motions as set by clients, with the subscribers to their changes.
#[derive(Default)]
pub(crate) struct OperatorControls {
    current: MotionControls,
    pub(super) watchers: Subscribers,
}

impl OperatorControls {
    /// Returns the speed override and the pause that were set last.
    pub(crate) fn current(&self) -> MotionControls {
        self.current
    }

    /// Stores a new speed override and pause and reports them to all subscribers.
    pub(super) fn set(&mut self, controls: MotionControls) {
        self.current = controls;
        self.watchers.notify(&Update::Controls(controls));
    }

    /// Subscribes to the speed override and the pause: reports them now and at each change.
    pub(crate) fn watch(&mut self, sink: Box<dyn Subscriber>) {
        self.watchers.add(sink, &Update::Controls(self.current));
    }
}
