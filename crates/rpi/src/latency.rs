//! `rpi latency`: measures which period this machine can hold.

use std::sync::Arc;

use rpi_core::{Continuity, MotionControls};
use rpi_runtime::latency::{CycleTiming, MeasuringOptions, measure, verdict};
use rpi_runtime::realtime::{RealTime, SchedulingOptions, TimeBase};
use rpi_runtime::run::{self, Limits, RunOptions};

use crate::exit::{CommandResult, Exit};
use crate::latency_args::LatencyArgs;
use crate::program;
use crate::target;
use crate::target_args::Target;

/// Carries out `rpi latency`: measures the wake-up delay of a thread, and prints the shortest period that the machine
/// can meet.
pub(crate) fn latency(args: &LatencyArgs) -> CommandResult {
    let load = args.program.as_ref().map(|_| load(args)).transpose()?;
    let count = (args.time / args.period).max(1);
    let wakes = measure(MeasuringOptions {
        resources: thread_settings(args),
        period_ns: args.period,
        count,
        busy_threads: args.load,
    })?;
    let verdict = verdict(wakes, load);
    rpi_cli::print(&match args.json {
        true => format!("{}\n", verdict.to_json()),
        false => verdict.to_string(),
    })?;
    Ok(Exit::Success)
}

fn thread_settings(args: &LatencyArgs) -> SchedulingOptions {
    SchedulingOptions {
        priority: args.priority,
        core: args.core,
    }
}

/// Runs the program that the options name in real time, and returns the statistics of its cycle times.
fn load(args: &LatencyArgs) -> Result<CycleTiming, Box<dyn std::error::Error>> {
    let path = args.program.clone().unwrap_or_default();
    let target = Target {
        cell: args.cell.clone(),
        command: args.command.clone(),
        period: Some(args.period),
        cycles: None,
        time: Some(args.time),
        settings: Vec::new(),
        watch: Vec::new(),
    };
    let compiled = program::load(&path, target::compile_options(&target)?)?;
    let bundle = target::task_bundle(&compiled, &target, target::lower_for_run)?;
    let (cell, _) = target::cell(&path, &target, &bundle)?;
    let outcome = run::run(RunOptions {
        images: &bundle.images,
        plans: std::slice::from_ref(&bundle.plan),
        cell: &cell,
        time_base: TimeBase::Real,
        real_time: RealTime {
            resources: thread_settings(args),
            ..RealTime::default()
        },
        continuity: Continuity::default(),
        budget: None,
        controls: MotionControls::default(),
        limits: Limits {
            ticks: target::ticks(&target, args.period),
            planning_ns: 0,
        },
        interrupted: Arc::default(),
        emergency: Arc::default(),
        next_tick: Arc::default(),
        settings: &[],
        recording: None,
        sink: &mut (),
        progress: None,
    })?;
    let figures = outcome.figures;
    Ok(CycleTiming {
        name: path.display().to_string(),
        cycle: figures.tick,
        late: figures.lateness.unwrap_or_default(),
    })
}
