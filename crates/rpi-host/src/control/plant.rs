//! The devices that an executive moves.

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
