//! Emergency stop: everything is stopped at once, and nothing can be started until a reset.
//!
//! The stop does not go through the request queue: the cycle reads an atomic flag in each tick and stops everything
//! while it is set. The flag is cleared once all earlier requests were carried out, so that none of them restarts a
//! command.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::{Failure, Reply, ServerState, Sink, Then, Update};

/// State of the emergency stop.
#[derive(Default)]
pub(crate) struct Emergency {
    /// Flag read by the cycle.
    alarm: Arc<AtomicBool>,
    /// Whether the request that marks the end of all earlier ones is still to be sent.
    waits: bool,
    /// Who requested the stop; `None` after a reset.
    by: Option<String>,
    pub(super) watchers: Vec<Box<dyn Sink>>,
}

/// Maximum number of characters kept of the requester's name.
const LONGEST: usize = 200;

impl ServerState {
    /// Returns the flag that the cycle reads.
    pub(crate) fn alarm(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.emergency.alarm)
    }

    /// Returns who requested the emergency stop in force.
    pub(crate) fn emergency_by(&self) -> Option<&str> {
        self.emergency.by.as_deref()
    }

    /// Stops everything. The reply is sent once no earlier request can start anything any more.
    pub(crate) fn emergency_stop(&mut self, by: &str, reply: Reply) {
        let by: String = by
            .chars()
            .filter(|c| !c.is_control())
            .take(LONGEST)
            .collect();
        self.journal.note(format_args!("EMERGENCY STOP by {by}"));
        self.emergency.alarm.store(true, Ordering::Relaxed);
        // The first requester is kept.
        self.emergency.by.get_or_insert(by);
        self.stop_tasks();
        self.ask_behind(Some(reply));
        self.tell_emergency();
    }

    /// Sends the stop as an ordinary request too, which is carried out after all pending ones.
    fn ask_behind(&mut self, reply: Option<Reply>) {
        let ticket = self.control.emergency_stop();
        self.emergency.waits = ticket.is_err();
        match ticket {
            Ok(ticket) => {
                self.asked(Ok(ticket), Then::Stopped, reply);
            }
            // The flag has stopped everything already, so the client need not wait for the repeated request.
            Err(_) => super::answer(reply, Ok(String::new())),
        }
    }

    /// Repeats the request if the queue was full.
    pub(super) fn keep_stopped(&mut self) {
        if self.emergency.waits {
            self.ask_behind(None);
        }
    }

    /// Called when all earlier requests were carried out: clears the flag.
    pub(super) fn has_stopped(&mut self) {
        self.emergency.alarm.store(false, Ordering::Relaxed);
    }

    /// Resets the emergency stop: commands can be started again.
    ///
    /// # Errors
    /// If a device still moves or earlier requests are pending.
    pub(crate) fn reset_emergency(&mut self) -> Result<(), Failure> {
        let still = self.emergency.alarm.load(Ordering::Relaxed) || self.devices.move_still();
        if self.emergency.by.is_some() && still {
            return Err(Failure::InUse("devices are still braking".to_owned()));
        }
        if self.emergency.by.take().is_some() {
            self.journal
                .note(format_args!("the emergency stop was reset"));
            self.tell_emergency();
        }
        Ok(())
    }

    /// Subscribes to the emergency stop: reports its state now and at each change.
    pub(crate) fn watch_emergency(&mut self, mut sink: Box<dyn Sink>) {
        if sink.tell(&Update::Emergency(self.emergency_by())) {
            self.emergency.watchers.push(sink);
        }
    }

    fn tell_emergency(&mut self) {
        let Emergency { by, watchers, .. } = &mut self.emergency;
        watchers.retain_mut(|sink| sink.tell(&Update::Emergency(by.as_deref())));
    }

    /// Returns an error if an emergency stop is in force.
    pub(super) fn may_start(&self) -> Result<(), Failure> {
        match &self.emergency.by {
            Some(by) => Err(Failure::Stopped(by.clone())),
            None => Ok(()),
        }
    }
}
