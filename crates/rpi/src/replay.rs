//! `rpi replay`: replays a recording, or a net against a recorded trace.

use std::path::PathBuf;

use rpi_cli::ExecutionTarget;
use rpi_driver::ClaimPolicy;
use rpi_record::mcap::{self, Recording};
use rpi_record::trace::Trace;
use rpi_replay::trace_compare::Options;

use crate::args::ReplayArgs;
use crate::c_target::ShadowedCommands;
use crate::exit::{CommandResult, Exit};
use crate::program;
use crate::run::is_mcap;

/// Carries out `rpi replay`: replays a recording, or a net against a recorded trace, and prints the differences.
pub(crate) fn replay(args: &ReplayArgs) -> CommandResult {
    if is_mcap(&args.net) {
        return match args.trace.is_empty() && args.command.is_none() {
            true => replay_recording(args),
            false => Err(
                "--trace and --command are for nets; a recording is compared with itself".into(),
            ),
        };
    }
    if args.against == ExecutionTarget::C {
        return Err(
            "--against c is for recordings (.mcap): a trace replaces computed values by recorded ones".into(),
        );
    }
    if args.trace.is_empty() {
        return Err(
            "no trace to compare with; add --trace FILE, or replay a recording (.mcap)".into(),
        );
    }
    let compiled = program::load(&args.net, ClaimPolicy::Off)?;
    let net = program::select_command(&compiled, &[], args.command.as_deref())?;
    let trace = read_joined(&args.trace)?;
    let options = Options {
        period_ns: args.period,
        tolerance: args.tolerance,
        ..Options::default()
    };
    let report = rpi_replay::trace_compare::replay(net, &trace, &options)?;
    rpi_cli::print(&match args.json {
        true => format!("{}\n", report.to_json()),
        false => report.to_string(),
    })?;
    Ok(verdict(report.agrees()))
}

/// Runs the commands of a recording again, compares every value with the recorded one, and prints the differences.
fn replay_recording(args: &ReplayArgs) -> CommandResult {
    let name = args.net.display();
    let recording = Recording::open(&args.net).map_err(|e| format!("{name}: {e}"))?;
    let mut in_c = ShadowedCommands::new(&args.compiler);
    let report = match args.against {
        ExecutionTarget::Core => mcap::replay(&recording),
        ExecutionTarget::C => mcap::replay_observed(&recording, &mut |tick, id, command| {
            in_c.cycle(tick, id, command);
        }),
    };
    let report = report.map_err(|e| format!("{name}: {e}"))?;
    rpi_cli::print(&match args.json {
        true => format!("{}\n", report.to_json()),
        false => report.to_string(),
    })?;
    if args.against == ExecutionTarget::C {
        match in_c.summary() {
            Ok(text) => rpi_diag::println_stderr!("{text}"),
            Err(text) => {
                rpi_diag::println_stderr!("{text}");
                return Ok(Exit::CommandError);
            }
        }
    }
    Ok(verdict(report.agrees()))
}

fn verdict(agrees: bool) -> Exit {
    match agrees {
        true => Exit::Success,
        false => Exit::CommandError,
    }
}

fn read_joined(paths: &[PathBuf]) -> Result<Trace, rpi_record::trace::FileReadError> {
    let mut joined = Trace::default();
    for path in paths {
        joined = joined.merged_with(&Trace::read(path)?);
    }
    Ok(joined)
}
