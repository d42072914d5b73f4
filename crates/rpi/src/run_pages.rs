//! Pages that show a run: the report, and the page that is open while the run goes on.

use std::error::Error;
use std::path::Path;

use rpi_driver::Compiled;
use rpi_record::mcap::LiveRun;
use rpi_serve::TaskBundle;

use crate::args::RunArgs;
use crate::interrupt::Interrupt;
use crate::run_report::RunReport;
use crate::run_view::RunView;

/// Pages that show a run, as far as the options request them.
pub(crate) struct RunPages {
    report: Option<RunReport>,
    view: Option<RunView>,
}

impl RunPages {
    /// Creates the file of the report and opens the page of the run.
    pub(crate) fn open(
        args: &RunArgs,
        compiled: &Compiled,
        bundle: &TaskBundle,
    ) -> Result<RunPages, Box<dyn Error>> {
        let report = RunReport::create(args)?;
        let view = RunView::open(args, (compiled, bundle), report.as_ref())?;
        Ok(RunPages { report, view })
    }

    /// Returns the path of the recording from which the pages are made.
    pub(crate) fn recording(&self) -> Option<&Path> {
        let report = self.report.as_ref().map(RunReport::recording);
        report.or(self.view.as_ref().map(RunView::recording))
    }

    /// Returns the receiver of the values of the run while it goes on.
    pub(crate) fn values(&self) -> Option<LiveRun> {
        self.view.as_ref().map(RunView::values)
    }

    /// Writes the report after the run, and shows the recording until the process is interrupted.
    pub(crate) fn finish(&self, interrupt: &Interrupt) -> Result<(), Box<dyn Error>> {
        if let Some(report) = &self.report {
            report.write()?;
        }
        let view = self.view.as_ref();
        view.map_or(Ok(()), |view| view.show_recording(interrupt))
    }
}
