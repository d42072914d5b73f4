//! The devices that an executive moves.

use rpi_device::DeviceBank;
use rpi_sim::SimBank;

/// A bank of devices with a time of its own.
pub trait Plant: DeviceBank + Send {
    /// Lets a tick pass, after the set-points of the tick were handed over.
    fn step(&mut self);

    /// Tells number, error code (0 for none) and motion of each device. Called in every tick: bounded, no allocation.
    fn conditions(&self, each: &mut dyn FnMut(usize, i64, bool));
}

impl Plant for SimBank {
    fn step(&mut self) {
        SimBank::step(self);
    }

    fn conditions(&self, each: &mut dyn FnMut(usize, i64, bool)) {
        for (number, status) in self.status().enumerate() {
            each(number, status.code.0, status.moving);
        }
    }
}
