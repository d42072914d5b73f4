//! Setup of a run: creates the cycle side, the host side and the queues between them.

use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use rpi_core::Command;
use rpi_image::claim::is_for_claim;
use rpi_image::image::Signal;
use rpi_image::{Image, Type};
use rpi_sim::SimBank;

use super::cycle::{Bounds, Cycle, Flows, Watcher};
use super::devices;
use super::host::{Books, Desk, Host};
use super::inputs::{self, Set};
use super::job::{Failure, Job};
use super::recorder::{Recorded, RunRecorder, StartRecording};
use super::samples::{Channel, Source, ring};
use super::sights::Sights;
use super::task::Task;
use crate::control::{Control, Executive, Options, open};
use crate::realtime::{Beat, Pace};
use crate::tape::{TapeIn, Taped, tape};

/// Creates the cycle side and the host side of a job.
pub(super) fn sides<'a>(
    job: &Job<'a>,
    tick_ns: u64,
    recording: Option<Box<dyn StartRecording>>,
) -> Result<(Cycle, Host<'a>), Failure> {
    let images: Vec<&Image> = job.images.iter().map(Arc::as_ref).collect();
    let sets = inputs::resolve(job.settings, &images).map_err(Failure::Setting)?;
    let bank = || SimBank::new(job.cell, tick_ns as f64 * 1e-9);
    let (mut plant, mut names) = (bank(), bank());
    fits(job, &mut names)?;
    let (taps, mut channels) = devices::taps(job.cell, &mut plant);
    let flows = flows(job.images, &mut channels);
    let types: Vec<Type> = channels.iter().map(|c| c.ty).collect();
    let (tap, drain) = ring(&types);
    let options = options(job, tick_ns);
    let (mut control, mut executive) = open(Taped::new(plant), Box::new(names), options);
    let ends = (&mut control, &mut executive);
    let recording =
        recording.map(|wanted| record(job, wanted, tick_ns, &channels[..taps.len()], ends));
    let recording = recording.transpose().map_err(Failure::Recording)?;
    let (recorder, tape) = recording.unzip();
    let sights = tape.is_some().then(|| Sights::new(job.images));
    let bounds = Bounds {
        last: job.limits.ticks.unwrap_or(u64::MAX),
        interrupted: Arc::clone(&job.interrupted),
        emergency: Arc::clone(&job.emergency),
        tick_ns,
    };
    let now = Arc::new(AtomicU64::new(0));
    let cycle = Cycle::new(
        executive,
        Beat::start(job.pace, tick_ns, job.real_time.overrun),
        Watcher {
            tap,
            tick: 0,
            flows,
            sights,
        },
        taps,
        Arc::clone(&now),
        bounds,
        tape,
    );
    let desk = desk(job, (control, sets), now, tick_ns);
    let host = Host {
        desk,
        tasks: job.plans.iter().map(Task::new).collect(),
        drain,
        channels,
        books: Books::new(job.images),
        last_tick: 0,
        recorder,
    };
    Ok((cycle, host))
}

/// Returns the capacities and policies of the control core.
fn options(job: &Job<'_>, tick_ns: u64) -> Options {
    Options {
        tick_ns,
        continuity: job.continuity,
        on_overrun: job.real_time.commands,
        timed: job.pace == Pace::Real,
        ..Options::default()
    }
}

/// Creates the state that tasks need to load and start commands.
fn desk<'a>(
    job: &Job<'a>,
    (control, sets): (Control, Vec<Vec<Set>>),
    now: Arc<AtomicU64>,
    tick_ns: u64,
) -> Desk<'a> {
    Desk {
        control,
        images: job.images,
        cell: job.cell,
        sets,
        now,
        planning: job.limits.planning_ns / tick_ns,
        late: 0,
        missed: 0,
    }
}

/// Starts the recording and returns its host side and its tape. The recorder receives every request from now on.
fn record(
    job: &Job<'_>,
    wanted: Box<dyn StartRecording>,
    tick_ns: u64,
    devices: &[Channel],
    (control, executive): (&mut Control, &mut Executive<Taped<SimBank>>),
) -> io::Result<(Box<dyn RunRecorder>, TapeIn)> {
    let (tape_in, tape_out) = tape();
    executive.plant().begin();
    let run = Recorded {
        cell: job.cell,
        channels: devices,
        tick_ns,
        continuity: job.continuity,
    };
    let recorder = wanted.start(run, tape_out)?;
    control.write_down(recorder.journal());
    Ok((recorder, tape_in))
}

/// Loads every command once to check that it can run in the cell and fits the time budget.
fn fits(job: &Job<'_>, names: &mut SimBank) -> Result<(), Failure> {
    let load = |image: &Arc<Image>| {
        let loaded = Command::load(Arc::clone(image), names);
        loaded.map_err(|faults| Failure::Loading {
            command: image.name.clone(),
            faults,
            devices: job.cell.devices.iter().map(|d| d.name.clone()).collect(),
        })
    };
    let commands: Result<Vec<Command>, Failure> = job.images.iter().map(load).collect();
    let mut commands = commands?;
    let share = job.share.as_ref();
    share.map_or(Ok(()), |share| share.admit(&mut commands, job.plans))
}

/// Adds a channel for each sampled flow and returns the flows of each image.
fn flows(images: &[Arc<Image>], channels: &mut Vec<Channel>) -> Box<[Flows]> {
    let mut of = |image: &Arc<Image>| {
        let mut flows = Vec::new();
        for (name, signal, fragment) in sampled_flows(image) {
            flows.push((channels.len(), signal, fragment));
            let key = name.strip_prefix(&image.name).unwrap_or(&name);
            let claims = is_for_claim(key.trim_start_matches('.'));
            channels.push(Channel {
                ty: signal.ty,
                source: match claims {
                    true => Source::Claim,
                    false => Source::Command,
                },
                name,
            });
        }
        Flows {
            image: Arc::clone(image),
            flows: flows.into(),
        }
    };
    images.iter().map(&mut of).collect()
}

/// Returns the sampled flows of an image with their fragments: all ports if the image was lowered with observable
/// ports, otherwise the exports. The index of a flow in this list is its key on the tape.
#[must_use]
pub fn sampled_flows(image: &Image) -> Vec<(String, Signal, u32)> {
    if image.probes.is_empty() {
        let exports = image.exports.iter();
        exports
            .map(|e| (format!("{}.{}", image.name, e.key), e.value, 0))
            .collect()
    } else {
        let probes = image.probes.iter();
        probes
            .map(|p| (image.probe_name(p), p.value, p.fragment))
            .collect()
    }
}
