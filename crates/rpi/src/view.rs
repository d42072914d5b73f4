//! `rpi view`: shows a recording in a browser, or writes it as a report.

use std::error::Error;
use std::io::Write;
use std::ops::Range;
use std::path::Path;
use std::process::{Command, Stdio};

use rpi_record::mcap::{Recording, RunData};
use rpi_view::ViewServer;

use crate::exit::{CommandResult, Exit};
use crate::output;
use crate::view_args::ViewArgs;

/// Carries out `rpi view`: serves the page of a recording until the process is interrupted, or writes a report.
pub(crate) fn view(args: &ViewArgs) -> CommandResult {
    let run = load(&args.recording, (args.from, args.to))?;
    if let Some(path) = &args.report {
        let file = output::create(path, &[&args.recording])?;
        write_report(&run, path, file)?;
        return Ok(Exit::Success);
    }
    let server = ViewServer::bind(&run, args.port)
        .map_err(|e| format!("port {} of this machine: {e}", args.port))?;
    // The numbers are in the document of the server from here on.
    drop(run);
    rpi_cli::print(format!("{}\n", server.url()))?;
    if !args.no_open {
        open_browser(&server.url());
    }
    server.serve()?;
    Ok(Exit::Success)
}

/// Loads the values of a recording between two times in ns since the start of the run.
pub(crate) fn load(
    path: &Path,
    (from, to): (Option<u64>, Option<u64>),
) -> Result<RunData, Box<dyn Error>> {
    let name = path.display();
    let recording = Recording::open(path).map_err(|e| format!("{name}: {e}"))?;
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

/// Writes the report of a run to the file `path`, which is open as `file`.
pub(crate) fn write_report(
    run: &RunData,
    path: &Path,
    mut file: impl Write,
) -> Result<(), Box<dyn Error>> {
    let written = rpi_view::report(run).and_then(|text| file.write_all(text.as_bytes()));
    written.map_err(|e| format!("{}: {e}", path.display()).into())
}

/// Opens an address in the browser of the user. A machine without one shows nothing: the address is printed as well.
fn open_browser(url: &str) {
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
