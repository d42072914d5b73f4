//! Emergency stop: everything is stopped at once, and nothing can be started until a reset.
//!
//! The stop does not go through the request queue: the cycle reads an atomic flag in each tick and stops everything
//! while it is set. The flag is cleared once all earlier requests were carried out, so that none of them restarts a
//! command.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::core_link::CoreLink;
use super::pending::{OnAnswer, answer};
use super::subscribers::Subscribers;
use super::types::{ApiError, Reply, Subscriber, Update};

/// State of the emergency stop in the server.
#[derive(Default)]
pub(crate) struct Emergency {
    /// Flag by which the cycle is requested to stop everything.
    stop_flag: Arc<AtomicBool>,
    /// Whether the stop must still be sent as a request, whose answer shows that all earlier requests are done.
    must_repeat: bool,
    /// Who requested the stop; `None` after a reset.
    requested_by: Option<String>,
    pub(super) watchers: Subscribers,
}

/// Maximum number of characters kept of the requester's name.
const MAX_NAME_CHARS: usize = 200;

/// Returns the name of a requester in the form that is kept and logged: one line of limited length.
pub(super) fn requester(by: &str) -> String {
    by.chars()
        .filter(|c| !c.is_control())
        .take(MAX_NAME_CHARS)
        .collect()
}

impl Emergency {
    /// Returns the flag that the cycle reads.
    pub(crate) fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop_flag)
    }

    /// Returns who requested the emergency stop in force.
    pub(crate) fn by(&self) -> Option<&str> {
        self.requested_by.as_deref()
    }

    /// Sets the flag: the cycle stops everything in its next tick.
    pub(super) fn raise(&mut self, by: String) {
        self.stop_flag.store(true, Ordering::Relaxed);
        // The first requester is kept.
        self.requested_by.get_or_insert(by);
    }

    /// Sends the stop as an ordinary request too, which the core carries out after all pending ones.
    pub(super) fn send_stop_request(&mut self, core: &mut CoreLink, reply: Option<Reply>) {
        let ticket = core.control.emergency_stop();
        self.must_repeat = ticket.is_err();
        match ticket {
            Ok(ticket) => {
                core.track_request(Ok(ticket), OnAnswer::Stopped, reply);
            }
            // The flag has stopped everything already, so the client need not wait for the repeated request.
            Err(_) => answer(reply, Ok(String::new())),
        }
    }

    /// Sends the request of [`Emergency::send_stop_request`] again if the queue was full.
    pub(super) fn repeat_stop_request(&mut self, core: &mut CoreLink) {
        if self.must_repeat {
            self.send_stop_request(core, None);
        }
    }

    /// Clears the flag. Called when all requests made before the stop were carried out.
    pub(super) fn clear_stop_flag(&mut self) {
        self.stop_flag.store(false, Ordering::Relaxed);
    }

    /// Resets the emergency stop: commands can be started again. Returns whether one was in force.
    ///
    /// # Errors
    /// If a device still moves or earlier requests are pending.
    pub(super) fn reset(&mut self, moving: bool) -> Result<bool, ApiError> {
        let still = self.stop_flag.load(Ordering::Relaxed) || moving;
        if self.requested_by.is_some() && still {
            return Err(ApiError::InUse("devices are still braking".to_owned()));
        }
        let was_stopped = self.requested_by.take().is_some();
        if was_stopped {
            self.notify();
        }
        Ok(was_stopped)
    }

    /// Subscribes to the emergency stop: reports its state now and at each change.
    pub(crate) fn watch(&mut self, sink: Box<dyn Subscriber>) {
        let by = self.requested_by.as_deref();
        self.watchers.add(sink, &Update::Emergency(by));
    }

    /// Reports the state to all subscribers.
    pub(super) fn notify(&mut self) {
        let by = self.requested_by.as_deref();
        self.watchers.notify(&Update::Emergency(by));
    }

    /// Returns an error if an emergency stop is in force.
    pub(super) fn ensure_not_stopped(&self) -> Result<(), ApiError> {
        match &self.requested_by {
            Some(by) => Err(ApiError::EmergencyStop(by.clone())),
            None => Ok(()),
        }
    }
}
