//! `rpi run --report`: the report of a run, from its recording.

use std::error::Error;
use std::fs::File;
use std::path::{Path, PathBuf};

use crate::args::RunArgs;
use crate::run::{create, is_mcap};
use crate::{recorded_run, view};

/// Report of a run that is written after the run, and the recording that it is made from.
pub(crate) struct RunReport {
    path: PathBuf,
    file: File,
    /// Recording of the run: the file of `--record`, or a temporary one.
    recording: PathBuf,
    is_temporary: bool,
    /// File of the program.
    program: PathBuf,
}

impl RunReport {
    /// Creates the file of the report. Returns `None` if the options request none.
    pub(crate) fn create(args: &RunArgs) -> Result<Option<RunReport>, Box<dyn Error>> {
        let Some(path) = &args.report else {
            return Ok(None);
        };
        let own = args.record.as_deref().filter(|path| is_mcap(path));
        Ok(Some(RunReport {
            path: path.clone(),
            file: create(path, args)?,
            recording: own.map_or_else(|| temporary(path), Path::to_path_buf),
            is_temporary: own.is_none(),
            program: args.program.clone(),
        }))
    }

    /// Returns the path of the recording that the report is made from.
    pub(crate) fn recording(&self) -> &Path {
        &self.recording
    }

    /// Writes the report after the run.
    pub(crate) fn write(&self) -> Result<(), Box<dyn Error>> {
        let loaded = recorded_run::load(&self.recording)?;
        view::write_report(&loaded, Some(&self.program), (&self.path, &self.file))
    }
}

impl Drop for RunReport {
    fn drop(&mut self) {
        if self.is_temporary {
            // The run may have ended before the recording began.
            let _ = std::fs::remove_file(&self.recording);
        }
    }
}

/// Returns the path of a temporary recording beside a report. It is on the same disk as the report, because the folder
/// for temporary files is often in memory, and a recording has any length.
fn temporary(report: &Path) -> PathBuf {
    let name = report.file_name().unwrap_or_default().to_string_lossy();
    report.with_file_name(format!(".{name}.{}.mcap", std::process::id()))
}
