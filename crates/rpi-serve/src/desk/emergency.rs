//! Emergency stop: everything is stopped at once, and nothing can be started until somebody resets it.
//!
//! It does not wait for its turn: the cycle looks at an alarm in each tick, and stops everything as long as it is up. It goes down
//! once all that had been asked for before was carried out, so that nothing which was on its way outlives it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::{Desk, Failure, Reply, Sink, Then, Update};

/// What is known of the emergency stop.
#[derive(Default)]
pub(crate) struct Emergency {
    /// Looked at by the cycle.
    alarm: Arc<AtomicBool>,
    /// The request behind all that had been asked for before has found no room yet.
    waits: bool,
    /// Who has wanted it, until it is reset.
    by: Option<String>,
    pub(super) watchers: Vec<Box<dyn Sink>>,
}

/// Signs that are kept of who wanted it.
const LONGEST: usize = 200;

impl Desk {
    /// What the cycle looks at.
    pub(crate) fn alarm(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.emergency.alarm)
    }

    /// Who has wanted an emergency stop that was not reset.
    pub(crate) fn emergency_by(&self) -> Option<&str> {
        self.emergency.by.as_deref()
    }

    /// Stops everything; the reply comes once it stands so that nothing can start any more.
    pub(crate) fn emergency_stop(&mut self, by: &str, reply: Reply) {
        let by: String = by
            .chars()
            .filter(|c| !c.is_control())
            .take(LONGEST)
            .collect();
        self.journal.note(format_args!("EMERGENCY STOP by {by}"));
        self.emergency.alarm.store(true, Ordering::Relaxed);
        // Who was first stays known.
        self.emergency.by.get_or_insert(by);
        self.stop_tasks();
        self.ask_behind(Some(reply));
        self.tell_emergency();
    }

    /// Asks for the same behind all that is under way.
    fn ask_behind(&mut self, reply: Option<Reply>) {
        let ticket = self.control.emergency_stop();
        self.emergency.waits = ticket.is_err();
        match ticket {
            Ok(ticket) => {
                self.asked(Ok(ticket), Then::Stopped, reply);
            }
            // It is stopped all the same; what is asked for again is only that nothing comes after it.
            Err(_) => super::answer(reply, Ok(String::new())),
        }
    }

    /// Tries again what found no room.
    pub(super) fn keep_stopped(&mut self) {
        if self.emergency.waits {
            self.ask_behind(None);
        }
    }

    /// All that was asked for before was carried out: the alarm can go down.
    pub(super) fn has_stopped(&mut self) {
        self.emergency.alarm.store(false, Ordering::Relaxed);
    }

    /// Lets commands start again.
    ///
    /// # Errors
    /// While something still moves.
    pub(crate) fn reset_emergency(&mut self) -> Result<(), Failure> {
        let still = self.emergency.alarm.load(Ordering::Relaxed) || self.devices.move_still();
        if self.emergency.by.is_some() && still {
            return Err(Failure::InUse("devices are still braking".to_owned()));
        }
        if self.emergency.by.take().is_some() {
            self.journal
                .note(format_args!("the emergency stop is reset"));
            self.tell_emergency();
        }
        Ok(())
    }

    /// Tells somebody whether everything is stopped, now and whenever that changes.
    pub(crate) fn watch_emergency(&mut self, mut sink: Box<dyn Sink>) {
        if sink.tell(&Update::Emergency(self.emergency_by())) {
            self.emergency.watchers.push(sink);
        }
    }

    fn tell_emergency(&mut self) {
        let Emergency { by, watchers, .. } = &mut self.emergency;
        watchers.retain_mut(|sink| sink.tell(&Update::Emergency(by.as_deref())));
    }

    /// Fails while everything is to stand still.
    pub(super) fn may_start(&self) -> Result<(), Failure> {
        match &self.emergency.by {
            Some(by) => Err(Failure::Stopped(by.clone())),
            None => Ok(()),
        }
    }
}
