//! `rpi replay`: a net against a recorded trace.

use std::path::PathBuf;

use rpi_driver::Claims;
use rpi_host::replay::Options;
use rpi_host::trace::Trace;

use crate::args::ReplayArgs;
use crate::exit::{Exit, Outcome};
use crate::output;
use crate::program;

/// Replays and prints the report.
pub(crate) fn replay(args: &ReplayArgs) -> Outcome {
    let compiled = program::load(&args.net, Claims::Off)?;
    let net = program::choose(compiled.nets(), &[], args.command.as_deref())?;
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
    Ok(if report.agrees() {
        Exit::Good
    } else {
        Exit::CommandError
    })
}

fn joined(paths: &[PathBuf]) -> Result<Trace, rpi_host::trace::ReadError> {
    let mut joined = Trace::default();
    for path in paths {
        joined = joined.merged(&Trace::read(path)?);
    }
    Ok(joined)
}
