//! Setup of a run: creates the cycle side, the host side and the queues between them.

use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use rpi_core::Command;
use rpi_image::claim::is_claim_key;
use rpi_image::image::Signal;
use rpi_image::{Image, Type};
use rpi_sim::SimBank;

use super::cycle::{CycleLoop, FlowSampler, SampledFlows, StopConditions};
use super::devices;
use super::host::{CommandLog, Host, TaskContext};
use super::inputs::{self, IndexedValue};
use super::job::{RunError, RunOptions};
use super::probe::FlowProbe;
use super::recorder::{Recorded, RunRecorder, StartRecording};
use super::samples::{Channel, Source, ring};
use super::task_runner::Task;
use crate::control::{Control, Executive, Options, open};
use crate::realtime::{TickTimer, TimeBase};
use crate::tick_log::{LoggingBank, TickLogWriter, tick_log};

/// Prepares a run: creates the loop of the cycle and the part of the run outside the cycle. `tick_ns` is the tick
/// length in nanoseconds; `recording` is started if there is one.
pub(super) fn setup<'a>(
    job: &RunOptions<'a>,
    tick_ns: u64,
    recording: Option<Box<dyn StartRecording>>,
) -> Result<(CycleLoop, Host<'a>), RunError> {
    let images: Vec<&Image> = job.images.iter().map(Arc::as_ref).collect();
    let sets = inputs::resolve(job.settings, &images).map_err(RunError::Setting)?;
    let bank = || SimBank::new(job.cell, tick_ns as f64 * 1e-9);
    let (mut plant, mut names) = (bank(), bank());
    check_commands(job, &mut names)?;
    let is_real_time = job.time_base == TimeBase::Real;
    plant.open(is_real_time).map_err(RunError::Device)?;
    let (taps, mut channels) = devices::taps(job.cell, &mut plant);
    let flows = add_flow_channels(job.images, &mut channels);
    let types: Vec<Type> = channels.iter().map(|c| c.ty).collect();
    let (tap, drain) = ring(&types);
    let options = options(job, tick_ns);
    let (mut control, mut executive) = open(LoggingBank::new(plant), Box::new(names), options);
    let ends = (&mut control, &mut executive);
    let recording = recording
        .map(|wanted| start_recording(job, wanted, tick_ns, &channels[..taps.len()], ends));
    let recording = recording.transpose().map_err(RunError::Recording)?;
    let (recorder, tick_log) = recording.unzip();
    // The request queue is empty, so there is room for this request.
    let _ = control.set_controls(job.controls);
    let probe = tick_log.is_some().then(|| FlowProbe::new(job.images));
    let bounds = StopConditions {
        last_tick: job.limits.ticks.unwrap_or(u64::MAX),
        interrupted: Arc::clone(&job.interrupted),
        emergency: Arc::clone(&job.emergency),
        tick_ns,
    };
    let now = Arc::clone(&job.next_tick);
    let cycle = CycleLoop::new(
        executive,
        TickTimer::start(job.time_base, tick_ns, job.real_time.overrun),
        FlowSampler {
            tap,
            tick: 0,
            flows,
            probe,
        },
        taps,
        Arc::clone(&now),
        bounds,
        tick_log,
    );
    let context = task_context(job, (control, sets), now, tick_ns);
    let host = Host {
        context,
        tasks: job.plans.iter().map(Task::new).collect(),
        drain,
        channels,
        command_log: CommandLog::new(job.images),
        last_tick: 0,
        recorder,
    };
    Ok((cycle, host))
}

/// Returns the capacities and policies of the control core of a run with this tick length in nanoseconds.
fn options(job: &RunOptions<'_>, tick_ns: u64) -> Options {
    Options {
        tick_ns,
        continuity: job.continuity,
        on_overrun: job.real_time.command_overrun,
        measure_commands: job.time_base == TimeBase::Real,
        ..Options::default()
    }
}

/// Creates the state that tasks need to load and start commands. `sets` are the input values given by the user; `now`
/// is the shared number of the next tick.
fn task_context<'a>(
    job: &RunOptions<'a>,
    (control, sets): (Control, Vec<Vec<IndexedValue>>),
    now: Arc<AtomicU64>,
    tick_ns: u64,
) -> TaskContext<'a> {
    TaskContext {
        control,
        images: job.images,
        cell: job.cell,
        input_values: sets,
        now,
        planning_ticks: job.limits.planning_ns / tick_ns,
        late_successors: 0,
        missed_takeovers: 0,
    }
}

/// Starts the recording of a run. `devices` are the channels of the sampled device ports. Returns the recorder, which
/// receives every request from now on, and the end of the tick log to which the cycle writes.
fn start_recording(
    job: &RunOptions<'_>,
    wanted: Box<dyn StartRecording>,
    tick_ns: u64,
    devices: &[Channel],
    (control, executive): (&mut Control, &mut Executive<LoggingBank<SimBank>>),
) -> io::Result<(Box<dyn RunRecorder>, TickLogWriter)> {
    let (writer, reader) = tick_log();
    executive.plant().start_logging();
    let run = Recorded {
        cell: job.cell,
        channels: devices,
        tick_ns,
        continuity: job.continuity,
    };
    let recorder = wanted.start(run, reader)?;
    control.set_request_log(recorder.request_log());
    Ok((recorder, writer))
}

/// Loads every command of a run once to check that it can run in the cell, and checks the time budget. `names` is a
/// copy of the devices for resolving their names.
fn check_commands(job: &RunOptions<'_>, names: &mut SimBank) -> Result<(), RunError> {
    let load = |image: &Arc<Image>| {
        let loaded = Command::load(Arc::clone(image), names);
        loaded.map_err(|faults| RunError::Load {
            command: image.name.clone(),
            faults,
            devices: job.cell.devices.iter().map(|d| d.name.clone()).collect(),
        })
    };
    let commands: Result<Vec<Command>, RunError> = job.images.iter().map(load).collect();
    let mut commands = commands?;
    let share = job.budget.as_ref();
    share.map_or(Ok(()), |share| share.check(&mut commands, job.plans))
}

/// Adds a channel for each flow that a run samples. Returns, for each image, its flows with the indices of their
/// channels.
fn add_flow_channels(images: &[Arc<Image>], channels: &mut Vec<Channel>) -> Box<[SampledFlows]> {
    let mut of = |image: &Arc<Image>| {
        let mut flows = Vec::new();
        for (name, signal, fragment) in sampled_flows(image) {
            flows.push((channels.len(), signal, fragment));
            let key = name.strip_prefix(&image.name).unwrap_or(&name);
            let claims = is_claim_key(key.trim_start_matches('.'));
            channels.push(Channel {
                ty: signal.ty,
                source: match claims {
                    true => Source::Claim,
                    false => Source::Command,
                },
                name,
            });
        }
        SampledFlows {
            image: Arc::clone(image),
            flows: flows.into(),
        }
    };
    images.iter().map(&mut of).collect()
}

/// Returns the flows of an image that are sampled in a run: name, place and type in memory, and index of the fragment.
/// These are all ports if the image was lowered with observable ports, otherwise the exports. The index of a flow in
/// this list is its key in the tick log.
#[must_use]
pub fn sampled_flows(image: &Image) -> Vec<(String, Signal, u32)> {
    if image.debug.probes.is_empty() {
        let exports = image.exports.iter();
        exports
            .map(|e| (format!("{}.{}", image.name, e.key), e.value, 0))
            .collect()
    } else {
        let probes = image.debug.probes.iter();
        probes
            .map(|p| (image.probe_name(p), p.value, p.fragment))
            .collect()
    }
}
