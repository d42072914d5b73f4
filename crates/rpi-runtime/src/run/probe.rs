//! Bit-exact observations of commands and devices for a recording.

use std::sync::Arc;

use rpi_core::{Command, CommandId, CycleObserver};
use rpi_image::Image;
use rpi_image::image::Signal;

use super::setup::sampled_flows;
use crate::tick_log::{EntryBuffer, EntryKind};

/// Capacity in 64-bit words of the buffer for the values that are recorded in one tick.
const CAPACITY: usize = 1 << 16;

/// Image of a command, and its recorded flows: place and type of each in memory, and the index of its fragment.
type RecordedFlows = (Arc<Image>, Box<[(Signal, u32)]>);

/// Probe that records the exact values of commands' flows at the end of each cycle, for the tick log.
pub struct FlowProbe {
    images: Vec<RecordedFlows>,
    stage: EntryBuffer,
}

impl FlowProbe {
    /// Creates a probe that records the sampled flows of these images. Commands with other images are recorded with
    /// their exports.
    #[must_use]
    pub fn new(images: &[Arc<Image>]) -> FlowProbe {
        let flows = |image: &Arc<Image>| {
            let flows = sampled_flows(image).into_iter();
            let flows = flows.map(|(_, signal, fragment)| (signal, fragment));
            (Arc::clone(image), flows.collect())
        };
        FlowProbe {
            images: images.iter().map(flows).collect(),
            stage: EntryBuffer::with_capacity(CAPACITY),
        }
    }

    /// Discards the values observed in the previous tick.
    pub fn begin(&mut self) {
        self.stage.clear();
    }

    /// Returns the buffer with the values recorded in this tick.
    #[must_use]
    pub fn stage(&self) -> &EntryBuffer {
        &self.stage
    }

    /// Records that the tick ended `late_ns` after the next one was due.
    pub(super) fn overrun(&mut self, late_ns: u64) {
        self.stage.push(EntryKind::Overrun, 0, false, &[&[late_ns]]);
    }

    /// Records the value of a device port after the tick. `channel` is the index of the port among the sampled ones;
    /// `value` is `None` if there is no sample.
    pub(super) fn sample(&mut self, channel: usize, value: Option<&[u64]>) {
        // There are fewer than 2^32 ports.
        let (key, cells) = (channel as u32, value.unwrap_or(&[]));
        self.stage
            .push(EntryKind::Sample, key, value.is_some(), &[cells]);
    }
}

impl CycleObserver for FlowProbe {
    fn cycle_finished(&mut self, id: CommandId, command: &Command) {
        let machine = command.instance();
        let mine = |(image, _): &&(Arc<Image>, _)| Arc::ptr_eq(image, machine.image());
        let stage = &mut self.stage;
        let mut note = |key: u32, signal: Signal, fragment: u32| {
            let value = machine.value(signal);
            let value = value.filter(|_| machine.is_active(fragment));
            let parts = [&[id.to_number()][..], value.unwrap_or(&[])];
            stage.push(EntryKind::Flow, key, value.is_some(), &parts);
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
