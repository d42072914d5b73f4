//! `rpi run --view`: the page that shows a run while it goes on, and its recording afterwards.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::Duration;

use rpi_driver::Compiled;
use rpi_graph::NetGraph;
use rpi_record::mcap::LiveRun;
use rpi_serve::TaskBundle;
use rpi_view::{Precision, SharedSource, ViewContent, ViewServer, ViewSource};

use crate::args::RunArgs;
use crate::interrupt::Interrupt;
use crate::recorded_nets::graphs;
use crate::recorded_run;
use crate::recorded_source::RecordedSource;
use crate::run::{is_mcap, run_sources};
use crate::run_report::RunReport;
use crate::target;
use crate::view::open_browser;

/// Time between two checks for an interrupt after the run.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Answer to requests that need a recording.
const GOES_ON: &str = "the run goes on; its recording is shown when it has ended";

/// Page of a run.
pub(crate) struct RunView {
    url: String,
    source: SharedSource,
    values: LiveRun,
    /// Recording of the run, which is shown at its end.
    recording: PathBuf,
    is_temporary: bool,
    program: PathBuf,
}

impl RunView {
    /// Opens the page of a run. Returns `None` if the options request none. `report` is the report of the run, whose recording is used,
    /// too.
    pub(crate) fn open(
        args: &RunArgs,
        (compiled, bundle): (&Compiled, &TaskBundle),
        report: Option<&RunReport>,
    ) -> Result<Option<RunView>, Box<dyn Error>> {
        let Some(port) = args.view.view else {
            return Ok(None);
        };
        let (_, cell) = target::cell(&args.program, &args.target, bundle)?;
        let values = LiveRun::new(&run_sources(args, cell)?);
        let runs = |name: &str| bundle.images.iter().any(|image| image.name == name);
        let nets = compiled.nets().iter().filter(|net| runs(&net.name));
        let source = LiveSource {
            run: values.clone(),
            nets: graphs(nets, &compiled.sources),
        };
        let server = ViewServer::bind(Arc::new(source), port)
            .map_err(|e| format!("port {port} of this machine: {e}"))?;
        let (url, source) = (server.url(), server.source());
        rpi_diag::println_stderr!("the run is shown at {url}");
        if !args.view.no_open {
            open_browser(&url);
        }
        let serve = move || server.serve();
        thread::Builder::new()
            .name("rpi-view".into())
            .spawn(serve)?;
        let own = args.record.as_deref().filter(|path| is_mcap(path));
        let known = own.or(report.map(RunReport::recording));
        Ok(Some(RunView {
            url,
            source,
            values,
            recording: known.map_or_else(temporary, Path::to_path_buf),
            is_temporary: known.is_none(),
            program: args.program.clone(),
        }))
    }

    /// Returns the path of the recording that is shown at the end.
    pub(crate) fn recording(&self) -> &Path {
        &self.recording
    }

    /// Returns the receiver of the values of the run.
    pub(crate) fn values(&self) -> LiveRun {
        self.values.clone()
    }

    /// Shows the recording of the run, which has ended, until the process is interrupted.
    pub(crate) fn show_recording(&self, interrupt: &Interrupt) -> Result<(), Box<dyn Error>> {
        let interrupted = interrupt.flag();
        if interrupted.load(Ordering::Relaxed) {
            return Ok(());
        }
        let loaded = recorded_run::load(&self.recording)?;
        let source = RecordedSource::new(loaded, Some(&self.program));
        self.source.set(Arc::new(source));
        rpi_diag::println_stderr!(
            "the run has ended; {} shows its recording until Ctrl-C",
            self.url
        );
        while !interrupted.load(Ordering::Relaxed) {
            thread::sleep(POLL_INTERVAL);
        }
        Ok(())
    }
}

impl Drop for RunView {
    fn drop(&mut self) {
        if self.is_temporary {
            // The run may have ended before the recording began.
            let _ = std::fs::remove_file(&self.recording);
        }
    }
}

/// Returns the path of a temporary recording.
fn temporary() -> PathBuf {
    let name = format!("rpi-view-{}.mcap", std::process::id());
    std::env::temp_dir().join(name)
}

/// A run that goes on, as the page shows it.
struct LiveSource {
    run: LiveRun,
    nets: Vec<NetGraph>,
}

impl ViewSource for LiveSource {
    fn document(&self) -> Arc<[u8]> {
        let run = self.run.since(0);
        let content = ViewContent {
            run: &run,
            nets: Ok(&self.nets),
            is_live: true,
        };
        rpi_view::document(content, Precision::Exact).into()
    }

    fn since(&self, tick: u64) -> Option<Vec<u8>> {
        let mut run = self.run.since(tick);
        // The page has these already.
        run.source = None;
        run.cell.clear();
        run.arms.clear();
        let content = ViewContent {
            run: &run,
            nets: Ok(&[]),
            is_live: true,
        };
        Some(rpi_view::document(content, Precision::Exact))
    }

    fn cycle(&self, _tick: u64) -> Result<String, String> {
        Err(GOES_ON.to_owned())
    }

    fn flow(&self, _name: &str) -> Result<Vec<u8>, String> {
        Err(GOES_ON.to_owned())
    }

    fn why(&self, _tick: u64, _name: &str) -> Result<String, String> {
        Err(GOES_ON.to_owned())
    }
}
