//! Everything comes to rest before the server lets go of the devices.

use rpi_host::control::State;

use super::{Desk, Phase, Then};

impl Desk {
    /// Ends all commands by force and drops all rules; what moves brakes on its own limits.
    pub(crate) fn stop_everything(&mut self) {
        let ticket = self.control.emergency_stop();
        self.asked(ticket, Then::Nothing, None);
    }

    /// Whether nothing runs, nothing is under way to the cycle, and all devices stand still. What a client has started after
    /// everything was stopped is stopped, too.
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
