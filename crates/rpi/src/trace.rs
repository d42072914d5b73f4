//! `rpi trace`: records all ports of a run, or selects rows of a trace.

use std::io::{BufWriter, Write};
use std::sync::Arc;

use rpi_core::{Continuity, MotionControls};
use rpi_driver::InputKind;
use rpi_record::sample_output::{RowFilter, TraceSink, copy_matching};
use rpi_runtime::realtime::{RealTime, TimeBase};
use rpi_runtime::run::{self, Limits, RunOptions};

use crate::args::TraceArgs;
use crate::exit::{CommandResult, Exit};
use crate::output;
use crate::program;
use crate::run::is_mcap;
use crate::target;

/// Carries out `rpi trace`: runs a program and writes the values of all ports as a trace, or prints the selected rows
/// of a recording.
pub(crate) fn trace(args: &TraceArgs) -> CommandResult {
    if is_mcap(&args.source) {
        let file = args.source.display();
        Err(format!("{file}: cannot select rows of an MCAP recording, only of .csv, .jsonl and .trace; `rpi replay` replays it").into())
    } else if InputKind::from_path(&args.source).is_some() {
        record(args)
    } else {
        let text = rpi_record::trace::read_text(&args.source)?;
        select_rows(args, &text)
    }
}

fn record(args: &TraceArgs) -> CommandResult {
    let compiled = program::load(&args.source, target::compile_options(&args.target)?)?;
    let bundle = target::task_bundle(&compiled, &args.target, |net, period| {
        Ok((rpi_driver::lower_for_observation(net, period)?, None))
    })?;
    target::ensure_inputs_set(&compiled, &args.target, &bundle)?;
    let (cell, _) = target::cell(&args.source, &args.target, &bundle)?;
    let tick_ns = bundle.images.first().map_or(1, |image| image.period_ns);
    let mut text = Vec::new();
    let mut traced = TraceSink::new(&mut text, 0)?;
    let outcome = run::run(RunOptions {
        images: &bundle.images,
        plans: std::slice::from_ref(&bundle.plan),
        cell: &cell,
        time_base: TimeBase::Simulated,
        real_time: RealTime::default(),
        continuity: Continuity::Allow,
        budget: None,
        controls: MotionControls::default(),
        limits: Limits {
            ticks: target::ticks(&args.target, tick_ns),
            planning_ns: 0,
        },
        interrupted: Arc::default(),
        emergency: Arc::default(),
        next_tick: Arc::default(),
        settings: &args.target.settings,
        recording: None,
        sink: &mut traced,
        progress: None,
    })?;
    traced.finish()?;
    rpi_diag::print_stderr!("{outcome}");
    select_rows(args, &String::from_utf8_lossy(&text))
}

fn select_rows(args: &TraceArgs, text: &str) -> CommandResult {
    let filter = RowFilter {
        flows: args.flow.clone(),
        cycles: args.from..args.to.saturating_add(1),
    };
    let mut out: Box<dyn Write> = match &args.output {
        Some(path) => Box::new(BufWriter::new(output::create(path, &[&args.source])?)),
        None => Box::new(BufWriter::new(std::io::stdout())),
    };
    let rows = copy_matching(text, &filter, &mut out);
    let rows = rpi_cli::ignore_broken_pipe(rows.and_then(|rows| out.flush().map(|()| rows)))?;
    if rows == Some(0) && !args.flow.is_empty() {
        rpi_diag::println_stderr!("no row matches the filter");
    }
    Ok(Exit::Success)
}
