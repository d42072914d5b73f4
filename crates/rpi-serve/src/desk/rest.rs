//! Shutdown: brings everything to rest before the devices are released.

use rpi_runtime::control::State;

use super::{Desk, Phase, Then};

impl Desk {
    /// Aborts all commands and drops all rules. Moving devices brake within their own limits.
    pub(crate) fn stop_everything(&mut self) {
        let ticket = self.control.emergency_stop();
        self.asked(ticket, Then::Nothing, None);
    }

    /// Returns whether no command runs, no request is pending and all devices are at rest. Commands started meanwhile
    /// are stopped again.
    pub(crate) fn has_come_to_rest(&mut self) -> bool {
        if !self.errands.is_empty() {
            return false;
        }
        let runs = [State::Running, State::Cancelling].map(Phase::Is);
        if self
            .commands
            .values()
            .any(|r| runs.contains(&r.status.phase))
        {
            self.stop_everything();
            return false;
        }
        !self.devices.move_still()
    }
}
