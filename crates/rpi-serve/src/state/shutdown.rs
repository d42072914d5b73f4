//! Shutdown: brings everything to rest before the devices are released.

use rpi_runtime::run::RecordingStats;

use super::ServerState;
use super::pending::OnAnswer;

impl ServerState {
    /// Aborts all commands and withdraws all rules. Moving devices brake within their own limits.
    pub(crate) fn stop_all(&mut self) {
        let ticket = self.core.control.emergency_stop();
        self.core.track_request(ticket, OnAnswer::Nothing, None);
    }

    /// Returns whether no command runs, no request is pending and all devices are at rest. Commands that were started
    /// meanwhile are aborted.
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

    /// Processes the remaining events after the last tick, ends the loader with its workers, closes the recording and
    /// returns its statistics; `None` if the run was not recorded. `lost` is the number of ticks that are missing from the
    /// recording.
    pub(crate) fn finish_recording(
        &mut self,
        lost: u64,
    ) -> std::io::Result<Option<RecordingStats>> {
        self.update();
        self.jobs.close();
        self.recording.finish(lost)
    }
}
