//! Recording of the run, and its messages for live viewers.

use rpi_record::mcap::Recorder;
use rpi_runtime::control::Event;
use rpi_runtime::run::RecordingStats;

use super::event_log::EventLog;

/// Recording of the run as seen by the server state. Without a recorder, the run is neither recorded nor has it live viewers, and
/// all methods do nothing.
pub(crate) struct Recording {
    recorder: Option<Recorder>,
    /// Whether the recording is still being written; false after an error or if the run is not recorded.
    is_recording: bool,
}

impl Recording {
    /// Creates the recording from its recorder; `None` if the run is not recorded and has no live viewers.
    pub(super) fn new(recorder: Option<Recorder>) -> Recording {
        Recording {
            is_recording: recorder.as_ref().is_some_and(Recorder::has_file),
            recorder,
        }
    }

    /// Returns whether the recording is still being written.
    pub(crate) fn is_recording(&self) -> bool {
        self.is_recording
    }

    /// Records an event of the cycle, if the run is recorded.
    pub(super) fn event(&self, event: &Event) {
        self.recorder.iter().for_each(|r| r.record_event(event));
    }

    /// Writes one warning for the operator when the recording has stopped because of a write error.
    pub(super) fn warn_if_failed(&mut self, log: &mut EventLog) {
        if self.is_recording
            && let Some(recorder) = self.recorder.as_ref().filter(|r| !r.is_writing())
        {
            self.is_recording = false;
            let why = recorder.write_error().unwrap_or("the writer has failed");
            let warning = format!("RECORDING STOPPED: {why}");
            log.warn(&warning);
        }
    }

    /// Closes the recording and returns its statistics; `None` if the run is not recorded. `lost` is the number of
    /// ticks that are missing from the recording.
    pub(super) fn finish(&mut self, lost: u64) -> std::io::Result<Option<RecordingStats>> {
        self.is_recording = false;
        let recorder = self.recorder.take();
        let finished = recorder.map(|recorder| recorder.finish(lost)).transpose();
        finished.map(Option::flatten)
    }
}
