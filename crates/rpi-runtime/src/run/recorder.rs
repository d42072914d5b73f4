//! Interface between a run and the recorder of its tick log.

use std::io;

use rpi_core::Continuity;
use rpi_sim::Cell;
use serde::Serialize;

use super::samples::Channel;
use crate::control::{Event, RequestLog};
use crate::tick_log::TickLogReader;

/// Properties of a run that its recording describes: cell, sampled device ports, tick length and policy.
#[derive(Clone, Copy)]
pub struct Recorded<'a> {
    /// Description of the cell whose devices the run uses.
    pub cell: &'a Cell,
    /// Device ports that are sampled after each tick.
    pub channels: &'a [Channel],
    /// Tick length in nanoseconds.
    pub tick_ns: u64,
    /// Policy for a takeover with a discontinuity of set-points, for commands without a policy of their own.
    pub continuity: Continuity,
}

/// A requested recording, which a run starts once the device ports to sample are known.
pub trait StartRecording {
    /// Starts the recording of a run. The returned recorder reads the ticks from the tick log.
    ///
    /// # Errors
    /// Returns the errors of the output, and an error if no thread can be created.
    fn start(
        self: Box<Self>,
        run: Recorded<'_>,
        tick_log: TickLogReader,
    ) -> io::Result<Box<dyn RunRecorder>>;
}

/// Recorder of a run, as used outside the cycle. No method but [`RunRecorder::finish`] blocks.
pub trait RunRecorder {
    /// Returns the callback that records each request to the control core.
    fn request_log(&self) -> RequestLog;

    /// Records an event of the core.
    fn event(&self, event: &Event);

    /// Returns true while the recorder reads ticks from the tick log. It stops after an error of the output.
    fn writes(&self) -> bool;

    /// Ends the recording. `lost` is the number of ticks for which the tick log had no room. Returns `None` if nothing was
    /// stored, because the messages of the run went to live viewers only.
    ///
    /// # Errors
    /// Returns the first error of the output, and an error if requests or events were dropped.
    fn finish(self: Box<Self>, lost: u64) -> io::Result<Option<RecordingStats>>;
}

/// Statistics of a finished recording.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize)]
pub struct RecordingStats {
    /// Number of ticks in the recording.
    pub ticks: u64,
    /// Number of ticks that are missing from the recording, because the writer could not keep up.
    pub lost: u64,
}
