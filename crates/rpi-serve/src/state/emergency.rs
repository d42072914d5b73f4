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

/// State of the emergency stop in the server: whether it is in force, who requested it, and the subscribers to it.
#[derive(Default)]
pub(crate) struct Emergency {
    /// Flag that the cycle reads in each tick; while it is set, the cycle aborts all commands.
    stop_flag: Arc<AtomicBool>,
    /// Whether the stop must still be sent as a request through the queue. The core's answer to it shows that all
    /// earlier requests are done.
    must_repeat: bool,
    /// Name of the first requester of the stop; `None` if no stop is in force.
    requested_by: Option<String>,
    /// Whether the operator is among the requesters of the stop. Then only the operator may reset it.
    is_operators: bool,
    pub(super) watchers: Subscribers,
}

/// Origin of a request for an emergency stop, or for its reset.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum StopOrigin {
    /// A client. For a reset: a client without the right to reset the operator's stop.
    Client,
    /// The operator: the terminal of the server, an input of the cell, or, for a reset, a client with the right to
    /// reset the operator's stop.
    Operator,
}

/// Maximum number of characters of the name of a requester; the rest of a longer name is cut off.
const MAX_NAME_CHARS: usize = 200;

/// Returns the name of a requester without control characters and cut to [`MAX_NAME_CHARS`] characters, for the log and
/// for messages.
pub(super) fn requester(by: &str) -> String {
    by.chars()
        .filter(|c| !c.is_control())
        .take(MAX_NAME_CHARS)
        .collect()
}

/// Error message for a client that must not reset an emergency stop of the operator.
const OPERATORS_STOP: &str = "the operator requested the emergency stop: it is reset at the server (signal SIGUSR1) or by a client with the role operator or admin";

impl Emergency {
    /// Returns the flag that the cycle reads in each tick; while it is set, the cycle aborts all commands.
    pub(crate) fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop_flag)
    }

    /// Returns the name of the requester of the emergency stop in force; `None` if no stop is in force.
    pub(crate) fn by(&self) -> Option<&str> {
        self.requested_by.as_deref()
    }

    /// Sets the flag by which the cycle aborts all commands in its next tick. `by` is the name of the requester.
    pub(super) fn raise(&mut self, by: String, origin: StopOrigin) {
        self.stop_flag.store(true, Ordering::Relaxed);
        self.is_operators |= origin == StopOrigin::Operator;
        // The first requester is kept.
        self.requested_by.get_or_insert(by);
    }

    /// Sends the stop also as a request through the queue, which the core carries out after all earlier requests.
    /// `reply` receives the core's answer, or an empty success at once if the queue is full.
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

    /// Sends the request of [`Emergency::send_stop_request`] again if the queue was full at the last attempt.
    pub(super) fn repeat_stop_request(&mut self, core: &mut CoreLink) {
        if self.must_repeat {
            self.send_stop_request(core, None);
        }
    }

    /// Clears the flag that stops the cycle's commands. Called once all requests made before the stop were carried out.
    pub(super) fn clear_stop_flag(&mut self) {
        self.stop_flag.store(false, Ordering::Relaxed);
    }

    /// Resets the emergency stop, so that commands can be started again. `moving` is whether any device moves. Returns
    /// whether a stop was in force.
    ///
    /// # Errors
    /// If only the operator may reset the stop, a device still moves, or earlier requests are pending.
    pub(super) fn reset(&mut self, moving: bool, origin: StopOrigin) -> Result<bool, ApiError> {
        if self.is_operators && origin == StopOrigin::Client {
            return Err(ApiError::Forbidden(OPERATORS_STOP.to_owned()));
        }
        let still = self.stop_flag.load(Ordering::Relaxed) || moving;
        if self.requested_by.is_some() && still {
            return Err(ApiError::InUse("devices are still braking".to_owned()));
        }
        let was_stopped = self.requested_by.take().is_some();
        self.is_operators = false;
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

    /// Reports the state of the emergency stop to all subscribers.
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
