//! Shutdown: brings everything to rest before the devices are released.

use rpi_runtime::run::RecordingStats;

use super::ServerState;
use super::pending::OnAnswer;

impl ServerState {
    /// Aborts all commands and drops all rules. Moving devices brake within their own limits.
    pub(crate) fn stop_all(&mut self) {
        let ticket = self.core.control.emergency_stop();
        self.core.track_request(ticket, OnAnswer::Nothing, None);
    }

    /// Returns whether no command runs, no request is pending and all devices are at rest. Commands started meanwhile
    /// are stopped again.
    pub(crate) fn is_at_rest(&mut self) -> bool {
        if !self.core.has_answered_all() {
            return false;
        }
        if self.objects.commands.any_runs() {
            self.stop_all();
            return false;
        }
        !self.devices.any_moving()
    }

    /// Processes the remaining events after the last tick, and closes the recording, which misses `lost` ticks.
    pub(crate) fn finish_recording(
        &mut self,
        lost: u64,
    ) -> std::io::Result<Option<RecordingStats>> {
        self.update();
        self.recording.finish(lost)
    }
}
