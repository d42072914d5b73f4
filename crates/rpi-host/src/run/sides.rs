//! Makes the two sides of a run and what lies between them.

use std::sync::Arc;

use rpi_core::Command;
use rpi_image::image::Signal;
use rpi_image::{Image, Type};
use rpi_sim::SimBank;

use super::clock::{Clock, Pace};
use super::cycle::{Bounds, Cycle, Flows, Watcher};
use super::devices;
use super::directory::Directory;
use super::figures::Meter;
use super::host::Host;
use super::inputs;
use super::job::{Failure, Job};
use super::links::links;
use super::samples::{Channel, Source, ring};

/// The cycle's and the host's side of a job.
pub(super) fn sides<'a>(job: &Job<'a>, tick_ns: u64) -> Result<(Cycle, Host<'a>), Failure> {
    let images: Vec<&Image> = job.images.iter().map(Arc::as_ref).collect();
    let sets = inputs::resolve(job.settings, &images).map_err(Failure::Setting)?;
    let mut bank = SimBank::new(job.cell, tick_ns as f64 * 1e-9);
    let directory = directory(job.images, &mut bank)?;
    let (taps, mut channels) = devices::taps(job.cell, &mut bank);
    let flows = flows(job.images, &mut channels);
    let types: Vec<Type> = channels.iter().map(|c| c.ty).collect();
    let (tap, drain) = ring(&types);
    let (cycle_ends, host_ends) = links();
    let bounds = Bounds {
        last: job.limits.ticks.unwrap_or(u64::MAX),
        planning: job.limits.planning_ns / tick_ns,
        tick_ns,
    };
    let cycle = Cycle::new(
        bank,
        (
            Clock::start(job.pace, tick_ns),
            Meter::new(job.pace == Pace::Real),
        ),
        cycle_ends,
        Watcher {
            tap,
            tick: 0,
            flows,
        },
        taps,
        bounds,
    );
    let host = Host {
        images: job.images,
        sets,
        directory,
        walk: Box::new(job.sequence.walk()),
        ends: host_ends,
        drain,
        channels,
        commands: Vec::new(),
        failed: None,
        last_tick: 0,
    };
    Ok((cycle, host))
}

/// Loads every command once to see that it fits, and learns the names of all ports by the way.
fn directory(images: &[Arc<Image>], bank: &mut SimBank) -> Result<Directory, Failure> {
    let mut directory = Directory::default();
    for image in images {
        let loaded = Command::load(Arc::clone(image), &mut directory.learn(bank));
        loaded.map_err(|faults| Failure::Loading {
            command: image.name.clone(),
            faults,
        })?;
    }
    Ok(directory)
}

/// What is sampled of each image: every port if it was lowered to be looked at, else what it exports.
fn flows(images: &[Arc<Image>], channels: &mut Vec<Channel>) -> Box<[Flows]> {
    let mut of = |image: &Arc<Image>| {
        let mut flows = Vec::new();
        for (name, signal, fragment) in named(image) {
            flows.push((channels.len(), signal, fragment));
            channels.push(Channel {
                name,
                ty: signal.ty,
                source: Source::Command,
            });
        }
        Flows {
            image: Arc::clone(image),
            flows: flows.into(),
        }
    };
    images.iter().map(&mut of).collect()
}

fn named(image: &Image) -> Vec<(String, Signal, u32)> {
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
