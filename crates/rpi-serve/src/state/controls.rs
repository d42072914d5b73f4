//! Override and pause of all motions: what an operator sets for the whole core.

use rpi_core::MotionControls;

use super::subscribers::Subscribers;
use super::types::{Subscriber, Update};

/// The override and the pause that are in force, and who watches them.
#[derive(Default)]
pub(crate) struct OperatorControls {
    current: MotionControls,
    watchers: Subscribers,
}

impl OperatorControls {
    /// Returns the controls that were set last.
    pub(crate) fn current(&self) -> MotionControls {
        self.current
    }

    /// Stores new controls and reports them to all subscribers.
    pub(super) fn set(&mut self, controls: MotionControls) {
        self.current = controls;
        self.watchers.notify(&Update::Controls(controls));
    }

    /// Subscribes to the controls: reports them now and at each change.
    pub(crate) fn watch(&mut self, sink: Box<dyn Subscriber>) {
        self.watchers.add(sink, &Update::Controls(self.current));
    }
}
