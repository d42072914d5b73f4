//! `rpi view`: shows a recording in a browser, or writes it as a report.

use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;

use rpi_view::ViewServer;

use crate::exit::{CommandResult, Exit};
use crate::output;
use crate::recorded_nets::RecordedNets;
use crate::recorded_run::LoadedRun;
use crate::recorded_source::RecordedSource;
use crate::view_args::ViewArgs;

/// Carries out `rpi view`: serves the page of a recording until the process is interrupted, or writes a report.
pub(crate) fn view(args: &ViewArgs) -> CommandResult {
    let loaded = args.run.load_with_recording()?;
    let program = args.run.program.as_deref();
    if let Some(path) = &args.report {
        let file = output::create(path, &[&args.run.recording])?;
        write_report(&loaded, program, (path, file))?;
        return Ok(Exit::Success);
    }
    let source = RecordedSource::new(loaded, program);
    let server = ViewServer::bind(Arc::new(source), args.port)
        .map_err(|e| format!("port {} of this machine: {e}", args.port))?;
    rpi_cli::print(format!("{}\n", server.url()))?;
    if !args.no_open {
        open_browser(&server.url());
    }
    server.serve()?;
    Ok(Exit::Success)
}

/// Writes the report of a run to the file `path`, which is open as `file`. `program` is the file of the program.
pub(crate) fn write_report(
    loaded: &LoadedRun,
    program: Option<&Path>,
    (path, mut file): (&Path, impl Write),
) -> Result<(), Box<dyn Error>> {
    let nets = RecordedNets::new(&loaded.recording, program);
    let content = nets.content(&loaded.run);
    let written = rpi_view::report(content).and_then(|text| file.write_all(text.as_bytes()));
    written.map_err(|e| format!("{}: {e}", path.display()).into())
}

/// Opens an address in the browser of the user. A machine without one shows nothing: the address is printed as well.
pub(crate) fn open_browser(url: &str) {
    let program = match std::env::consts::OS {
        "macos" => "open",
        "windows" => "explorer",
        _ => "xdg-open",
    };
    let _ = Command::new(program)
        .arg(url)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
}
