//! `rpi view`: shows a recording in a browser, or writes it as a report.

use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use rpi_record::mcap::RunData;
use rpi_view::ViewServer;

use crate::exit::{CommandResult, Exit};
use crate::output;
use crate::view_args::ViewArgs;

/// Carries out `rpi view`: serves the page of a recording until the process is interrupted, or writes a report.
pub(crate) fn view(args: &ViewArgs) -> CommandResult {
    let run = args.run.load()?;
    if let Some(path) = &args.report {
        let file = output::create(path, &[&args.run.recording])?;
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
