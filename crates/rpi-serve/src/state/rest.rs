//! Shutdown: brings everything to rest before the devices are released.

use rpi_runtime::run::Written;

use super::ServerState;
use super::pending::Then;

impl ServerState {
    /// Aborts all commands and drops all rules. Moving devices brake within their own limits.
    pub(crate) fn stop_everything(&mut self) {
        let ticket = self.core.control.emergency_stop();
        self.core.asked(ticket, Then::Nothing, None);
    }

    /// Returns whether no command runs, no request is pending and all devices are at rest. Commands started meanwhile
    /// are stopped again.
    pub(crate) fn has_come_to_rest(&mut self) -> bool {
        if !self.core.has_answered_all() {
            return false;
        }
        if self.objects.commands.any_runs() {
            self.stop_everything();
            return false;
        }
        !self.devices.move_still()
    }

    /// Called after the last tick: processes the remaining events and closes the recording, which misses `lost` ticks.
    pub(crate) fn finish_recording(&mut self, lost: u64) -> std::io::Result<Option<Written>> {
        self.keep();
        self.recording.finish(lost)
    }
}
