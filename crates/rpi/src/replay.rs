//! `rpi replay`: a recording once more, or a net against a recorded trace.

use std::path::PathBuf;

use rpi_driver::Claims;
use rpi_host::recording::{Recording, rerun};
use rpi_host::replay::Options;
use rpi_host::trace::Trace;

use crate::args::ReplayArgs;
use crate::exit::{Exit, Outcome};
use crate::output;
use crate::program;
use crate::run::is_recording;

/// Replays and prints the report.
pub(crate) fn replay(args: &ReplayArgs) -> Outcome {
    if is_recording(&args.net) {
        return match args.trace.is_empty() && args.command.is_none() {
            true => again(args),
            false => Err("a recording is compared with itself, as a whole: --trace and --command are for nets".into()),
        };
    }
    if args.trace.is_empty() {
        return Err("against which trace? Say --trace FILE, or give a recording (.mcap)".into());
    }
    let compiled = program::load(&args.net, Claims::Off)?;
    let net = program::choose(&compiled, &[], args.command.as_deref())?;
    let trace = joined(&args.trace)?;
    let options = Options {
        period_ns: args.period,
        tolerance: args.tolerance,
        ..Options::default()
    };
    let report = rpi_host::replay::replay(net, &trace, &options)?;
    output::put(&match args.json {
        true => format!("{}\n", report.to_json()),
        false => report.to_string(),
    })?;
    Ok(verdict(report.agrees()))
}

/// Runs a recording again.
fn again(args: &ReplayArgs) -> Outcome {
    let name = args.net.display();
    let bytes = std::fs::read(&args.net).map_err(|e| format!("{name}: {e}"))?;
    let recording = Recording::read(&bytes).map_err(|e| format!("{name}: {e}"))?;
    let report = rerun(&recording).map_err(|e| format!("{name}: {e}"))?;
    output::put(&match args.json {
        true => format!("{}\n", report.to_json()),
        false => report.to_string(),
    })?;
    Ok(verdict(report.agrees()))
}

fn verdict(agrees: bool) -> Exit {
    match agrees {
        true => Exit::Good,
        false => Exit::CommandError,
    }
}

fn joined(paths: &[PathBuf]) -> Result<Trace, rpi_host::trace::ReadError> {
    let mut joined = Trace::default();
    for path in paths {
        joined = joined.merged(&Trace::read(path)?);
    }
    Ok(joined)
}
