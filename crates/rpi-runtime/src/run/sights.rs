//! Bit-exact observations of commands and devices for a recording.

use std::sync::Arc;

use rpi_core::{Command, CommandId, Watch};
use rpi_image::Image;
use rpi_image::image::Signal;

use super::sides::sampled_flows;
use crate::tape::{Kind, Stage};

/// Capacity in words of the observations of one tick.
const CAPACITY: usize = 1 << 16;

/// An image and its recorded flows with their fragments.
type Noted = (Arc<Image>, Box<[(Signal, u32)]>);

/// Records the flows of commands at the end of their cycles.
pub struct Sights {
    images: Vec<Noted>,
    stage: Stage,
}

impl Sights {
    /// Creates an observer. For images that are not listed here, the exports are recorded.
    #[must_use]
    pub fn new(images: &[Arc<Image>]) -> Sights {
        let flows = |image: &Arc<Image>| {
            let flows = sampled_flows(image).into_iter();
            let flows = flows.map(|(_, signal, fragment)| (signal, fragment));
            (Arc::clone(image), flows.collect())
        };
        Sights {
            images: images.iter().map(flows).collect(),
            stage: Stage::with_capacity(CAPACITY),
        }
    }

    /// Discards the observations of the previous tick.
    pub fn begin(&mut self) {
        self.stage.clear();
    }

    /// Returns the observations of this tick.
    #[must_use]
    pub fn stage(&self) -> &Stage {
        &self.stage
    }

    /// Records that the tick ended `late_ns` after the next one was due.
    pub(super) fn overrun(&mut self, late_ns: u64) {
        self.stage.put(Kind::Overrun, 0, false, &[&[late_ns]]);
    }

    /// Records the value of a device port after the tick.
    pub(super) fn sample(&mut self, channel: usize, value: Option<&[u64]>) {
        // There are fewer than 2^32 ports.
        let (key, cells) = (channel as u32, value.unwrap_or(&[]));
        self.stage.put(Kind::Sample, key, value.is_some(), &[cells]);
    }
}

impl Watch for Sights {
    fn cycle(&mut self, id: CommandId, command: &Command) {
        let machine = command.machine();
        let mine = |(image, _): &&(Arc<Image>, _)| Arc::ptr_eq(image, machine.image());
        let stage = &mut self.stage;
        let mut note = |key: u32, signal: Signal, fragment: u32| {
            let value = machine.value(signal);
            let value = value.filter(|_| machine.is_active(fragment));
            let parts = [&[id.number()][..], value.unwrap_or(&[])];
            stage.put(Kind::Flow, key, value.is_some(), &parts);
        };
        match self.images.iter().find(mine) {
            Some((_, flows)) => (0..).zip(flows).for_each(|(k, f)| note(k, f.0, f.1)),
            // The same flows as `sampled_flows` returns for an image without observable ports.
            None => (0..)
                .zip(&machine.image().exports)
                .for_each(|(k, e)| note(k, e.value, 0)),
        }
    }
}
