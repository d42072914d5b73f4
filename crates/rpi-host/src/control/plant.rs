//! The devices that an executive moves.

use rpi_core::CommandId;
use rpi_device::DeviceBank;
use rpi_sim::{Part, SimBank};

/// A bank of devices with a time of its own.
pub trait Plant: DeviceBank + Send {
    /// A device to be put into a place.
    type Part: Send;

    /// Puts a device into a place, or none, and gives what was there.
    fn swap(&mut self, place: usize, part: Option<Self::Part>) -> Option<Self::Part>;

    /// Lets a tick pass, after the set-points of the tick were handed over.
    fn step(&mut self);

    /// Tells place, error code (0 for none) and motion of each device. Called in every tick: bounded, no allocation.
    fn conditions(&self, each: &mut dyn FnMut(usize, i64, bool));

    /// A tick ended too late: for who writes down what has happened.
    fn too_late(&mut self, _: &Late) {}
}

/// A tick that ended too late.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Late {
    /// Who took the longest in it.
    pub command: CommandId,
    /// For so many nanoseconds.
    pub took_ns: u64,
    /// By so many nanoseconds.
    pub late_ns: u64,
    /// Where in the command, as an index into its image's fragments.
    pub fragment: u32,
}

impl Plant for SimBank {
    type Part = Part;

    fn swap(&mut self, place: usize, part: Option<Part>) -> Option<Part> {
        SimBank::swap(self, place, part)
    }

    fn step(&mut self) {
        SimBank::step(self);
    }

    fn conditions(&self, each: &mut dyn FnMut(usize, i64, bool)) {
        for status in self.status() {
            each(status.place, status.code.0, status.moving);
        }
    }
}
