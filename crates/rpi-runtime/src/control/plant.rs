//! Interface to the devices of an executive.

use rpi_core::CommandId;
use rpi_device::DeviceBank;
use rpi_sim::{NamedDevice, SimBank};

/// A device bank (all devices of a cell) that advances in ticks.
pub trait Plant: DeviceBank + Send {
    /// Type of a device that can be inserted at run time.
    type Device: Send;

    /// Replaces the device at the index `place` by `part`, or removes it if `part` is `None`. Returns the previous
    /// device.
    fn swap(&mut self, place: usize, part: Option<Self::Device>) -> Option<Self::Device>;

    /// Advances the devices by one tick. Called after the set-points of the tick were written.
    fn step(&mut self);

    /// Calls `each` for every device, with its index, its error code (0 for none) and whether it moves. Called in every
    /// tick, so the method must have bounded time and must not allocate.
    fn device_states(&self, each: &mut dyn FnMut(usize, i64, bool));

    /// Notifies the device bank that a tick ended after the next one was due. Recording banks write it to their log.
    fn on_overrun(&mut self, _: &AttributedOverrun) {}
}

/// Overrun, that is a tick that ended after the next one was due, with the command to which it is attributed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct AttributedOverrun {
    /// Command that took the longest in the tick.
    pub command: CommandId,
    /// Computing time of the command in nanoseconds.
    pub took_ns: u64,
    /// Time in nanoseconds by which the tick ended after the next one was due.
    pub late_ns: u64,
    /// Fragment of the command with the most work in the tick, as an index into the fragments of the command's image.
    pub fragment: u32,
}

impl Plant for SimBank {
    type Device = NamedDevice;

    fn swap(&mut self, place: usize, part: Option<NamedDevice>) -> Option<NamedDevice> {
        SimBank::swap(self, place, part)
    }

    fn step(&mut self) {
        SimBank::step(self);
    }

    fn device_states(&self, each: &mut dyn FnMut(usize, i64, bool)) {
        for status in self.status() {
            each(status.index, status.code.0, status.moving);
        }
    }
}
