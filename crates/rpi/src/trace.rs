//! `rpi trace`: records all ports of a run, or selects rows of a trace.

use std::io::{BufWriter, Write};
use std::sync::Arc;

use rpi_core::Continuity;
use rpi_driver::Claims;
use rpi_driver::Kind;
use rpi_record::record::{Filter, Traced, copy};
use rpi_runtime::realtime::{Pace, RealTime};
use rpi_runtime::run::{self, Job, Limits};

use crate::args::TraceArgs;
use crate::exit::{Exit, Outcome};
use crate::output;
use crate::program;
use crate::run::is_recording;
use crate::target;

/// Runs the subcommand.
pub(crate) fn trace(args: &TraceArgs) -> Outcome {
    if is_recording(&args.source) {
        let file = args.source.display();
        Err(format!("{file}: cannot select rows of an MCAP recording, only of .csv, .jsonl and .trace; `rpi replay` replays it").into())
    } else if Kind::of(&args.source).is_some() {
        record(args)
    } else {
        let text = rpi_record::trace::read_text(&args.source)?;
        pick(args, &text)
    }
}

fn record(args: &TraceArgs) -> Outcome {
    let compiled = program::load(&args.source, Claims::Off)?;
    let script = target::script(&compiled, &args.target, |net, period| {
        rpi_driver::lower_to_look(net, period).map(|image| (image, None))
    })?;
    target::has_all(&compiled, &args.target, &script)?;
    let (cell, _) = target::cell(&args.source, &args.target, &script)?;
    let tick_ns = script.images.first().map_or(1, |image| image.period_ns);
    let mut text = Vec::new();
    let mut traced = Traced::new(&mut text, 0)?;
    let outcome = run::run(Job {
        images: &script.images,
        plans: std::slice::from_ref(&script.plan),
        cell: &cell,
        pace: Pace::Simulated,
        real_time: RealTime::default(),
        continuity: Continuity::Allow,
        share: None,
        limits: Limits {
            ticks: target::ticks(&args.target, tick_ns),
            planning_ns: 0,
        },
        interrupted: Arc::default(),
        emergency: Arc::default(),
        settings: &args.target.settings,
        recording: None,
        sink: &mut traced,
        progress: None,
    })?;
    traced.finish()?;
    rpi_diag::tell!("{outcome}");
    pick(args, &String::from_utf8_lossy(&text))
}

fn pick(args: &TraceArgs, text: &str) -> Outcome {
    let filter = Filter {
        flows: args.flow.clone(),
        cycles: args.from..args.to.saturating_add(1),
    };
    let mut out: Box<dyn Write> = match &args.output {
        Some(path) => Box::new(BufWriter::new(output::create(path, &[&args.source])?)),
        None => Box::new(BufWriter::new(std::io::stdout())),
    };
    let rows = copy(text, &filter, &mut out);
    let rows = output::quietly(rows.and_then(|rows| out.flush().map(|()| rows)))?;
    if rows == Some(0) && !args.flow.is_empty() {
        rpi_diag::tell_line!("no row matches the filter");
    }
    Ok(Exit::Good)
}
