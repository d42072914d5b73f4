//! Interface to the devices of an executive.

use rpi_core::CommandId;
use rpi_device::DeviceBank;
use rpi_sim::{NamedDevice, SimBank};

/// A device bank that advances in ticks.
pub trait Plant: DeviceBank + Send {
    /// A device that can be inserted at run time.
    type Device: Send;

    /// Replaces the device at an index, or removes it if `part` is `None`. Returns the previous device.
    fn swap(&mut self, place: usize, part: Option<Self::Device>) -> Option<Self::Device>;

    /// Advances the devices by one tick. Called after the set-points of the tick were written.
    fn step(&mut self);

    /// Calls `each` with the index, the error code (0 for none) and whether it moves, for every device. Called in every
    /// tick, so it must have bounded time and must not allocate.
    fn device_states(&self, each: &mut dyn FnMut(usize, i64, bool));

    /// Notifies the plant that a tick ended too late. Used by recordings.
    fn on_overrun(&mut self, _: &AttributedOverrun) {}
}

/// A tick that ended too late, attributed to a command.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct AttributedOverrun {
    /// Command that took the longest in the tick.
    pub command: CommandId,
    /// Computing time of the command in nanoseconds.
    pub took_ns: u64,
    /// Time in nanoseconds by which the tick ended too late.
    pub late_ns: u64,
    /// Fragment with the most work, as an index into the fragments of the command's image.
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
