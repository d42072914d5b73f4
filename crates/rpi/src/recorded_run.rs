//! Values of a recording, for `rpi view`, `rpi export` and reports.

use std::error::Error;
use std::ops::Range;
use std::path::Path;

use rpi_record::mcap::{Recording, RunData};

use crate::view_args::RecordedRun;
use crate::watched_recording;

/// A recording with its values, for the page that shows it.
pub(crate) struct LoadedRun {
    /// The recording as it was made.
    pub(crate) recording: Recording,
    /// Its values, with the watched flows.
    pub(crate) run: RunData,
}

impl RecordedRun {
    /// Loads the values that the options select.
    ///
    /// # Errors
    /// Returns an error if the recording cannot be read or replayed, or has no cycles in the selected time.
    pub(crate) fn load(&self) -> Result<RunData, Box<dyn Error>> {
        self.load_with_recording().map(|loaded| loaded.run)
    }

    /// Loads the values that the options select, with the recording.
    ///
    /// # Errors
    /// As [`RecordedRun::load`].
    pub(crate) fn load_with_recording(&self) -> Result<LoadedRun, Box<dyn Error>> {
        let recording = open(&self.recording)?;
        let mut watched = recording.clone();
        if !self.watch.is_empty() {
            watched_recording::watch(&mut watched, &self.watch, self.program.as_deref())?;
        }
        let run = run_data(&watched, &self.recording, (self.from, self.to))?;
        Ok(LoadedRun { recording, run })
    }
}

/// Loads all recorded values of a recording.
pub(crate) fn load(path: &Path) -> Result<LoadedRun, Box<dyn Error>> {
    let recording = open(path)?;
    let run = run_data(&recording, path, (None, None))?;
    Ok(LoadedRun { recording, run })
}

/// Opens a recording; the message of an error begins with its name.
pub(crate) fn open(path: &Path) -> Result<Recording, Box<dyn Error>> {
    Recording::open(path).map_err(|e| format!("{}: {e}", path.display()).into())
}

/// Returns the values between two times in ns since the start of the run.
fn run_data(
    recording: &Recording,
    path: &Path,
    (from, to): (Option<u64>, Option<u64>),
) -> Result<RunData, Box<dyn Error>> {
    let name = path.display();
    let tick = |ns: u64| ns / recording.tick_ns;
    let ticks: Range<u64> = from.map_or(0, tick)..to.map_or(u64::MAX, tick);
    if ticks.is_empty() {
        return Err("--from must be before --to".into());
    }
    let run = recording
        .run_data(ticks)
        .map_err(|e| format!("{name}: {e}"))?;
    match run.ticks.is_empty() {
        true => Err(format!("{name}: there are no cycles in this time").into()),
        false => Ok(run),
    }
}
