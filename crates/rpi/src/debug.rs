//! `rpi debug`: goes through the cycles of a recording, or of a simulated run, forwards and backwards.

use std::io::{self, BufReader, IsTerminal};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use clap::Args;
use rpi_driver::InputKind;
use serde_json::{Value, json};

use crate::exit::{CommandResult, Exit};
use crate::own_program::own_program;

/// Time of the cell after which the run of a program is stopped, if no other one is given.
const LONGEST: &str = "60s";

/// Options of `rpi debug`.
#[derive(Args, Debug)]
pub(crate) struct DebugArgs {
    /// Recording (.mcap), or a program that is run on simulated time first.
    #[arg(required_unless_present = "dap")]
    file: Option<PathBuf>,
    /// Program that was recorded, if it consists of several files.
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
    /// Cell description for the run of a program; default: `cell.toml` beside it.
    #[arg(long, value_name = "FILE")]
    cell: Option<PathBuf>,
    /// Command or task to run, if the program has several.
    #[arg(long, value_name = "NAME")]
    command: Option<String>,
    /// Stop the run of a program after this time, such as 10s; default: 60s.
    #[arg(long, value_name = "TIME")]
    time: Option<String>,
    /// Speak the Debug Adapter Protocol on the standard input and output, for editors. What is debugged comes with the request
    /// `launch`: `recording`, or `program` with `cell`, `command` and `time`.
    #[arg(long)]
    dap: bool,
}

/// Carries out `rpi debug`.
pub(crate) fn debug(args: &DebugArgs) -> CommandResult {
    let recording = TemporaryRecording::new();
    let launch = |arguments: &Value| record_run(arguments, &recording.path);
    if args.dap {
        let input = BufReader::new(io::stdin());
        rpi_debug::serve(input, io::stdout(), &launch)?;
        return Ok(Exit::Success);
    }
    rpi_debug::terminal(
        io::stdin().lock(),
        &mut io::stdout(),
        (&launch, launch_arguments(args)),
        io::stdin().is_terminal(),
    )?;
    Ok(Exit::Success)
}

/// Returns the arguments of a `launch` request for the options of the command line.
fn launch_arguments(args: &DebugArgs) -> Value {
    let file = args.file.as_deref().unwrap_or(Path::new(""));
    let text = |path: &Option<PathBuf>| {
        path.as_ref()
            .map(|path| path.to_string_lossy().into_owned())
    };
    let mut arguments = json!({
        "program": text(&args.program),
        "cell": text(&args.cell),
        "command": args.command,
        "time": args.time,
    });
    let is_program = InputKind::from_path(file).is_some();
    let key = if is_program { "program" } else { "recording" };
    arguments[key] = json!(file.to_string_lossy());
    arguments
}

/// Runs the program that the arguments name on simulated time, and records the run to `path`.
///
/// # Errors
/// Returns the messages of the run if it has recorded nothing.
fn record_run(arguments: &Value, path: &Path) -> Result<PathBuf, String> {
    let program = arguments["program"].as_str();
    let program =
        program.ok_or("`launch` needs `recording`, a recording, or `program`, a program to run")?;
    // That of an earlier run must not be taken for this one.
    let _ = std::fs::remove_file(path);
    let own = own_program().map_err(|error| error.to_string())?;
    let mut run = Command::new(own);
    run.args(["run", program, "--sim-time", "--record"])
        .arg(path);
    for (key, option) in [("cell", "--cell"), ("command", "--command")] {
        if let Some(value) = arguments[key].as_str() {
            run.args([option, value]);
        }
    }
    // A program may run without end.
    run.args(["--time", arguments["time"].as_str().unwrap_or(LONGEST)]);
    let done = run.stdin(Stdio::null()).output();
    let done = done.map_err(|error| error.to_string())?;
    // A run that ends with an error is what one wants to see in a debugger.
    match path.exists() {
        true => Ok(path.to_owned()),
        false => Err(String::from_utf8_lossy(&done.stderr).into_owned()),
    }
}

/// Recording of a run that is deleted at the end.
struct TemporaryRecording {
    path: PathBuf,
}

impl TemporaryRecording {
    fn new() -> TemporaryRecording {
        let name = format!("rpi-debug-{}.mcap", std::process::id());
        TemporaryRecording {
            path: std::env::temp_dir().join(name),
        }
    }
}

impl Drop for TemporaryRecording {
    fn drop(&mut self) {
        // It does not exist if nothing was run.
        let _ = std::fs::remove_file(&self.path);
    }
}
