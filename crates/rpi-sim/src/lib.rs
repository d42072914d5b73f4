//! Simulated devices and the description of a cell.
//!
//! [`Cell`] is what `cell.toml` says; [`SimBank`] is the devices it describes, as the core sees devices. The host calls
//! [`SimBank::step`] once per tick, after all commands have handed over their set-points. Everything is a function of the
//! cell, the set-points and the number of ticks: no clock, no randomness but seeded noise, no allocation in a tick.
//!
//! This crate must not know commands, nets or programs.

pub mod arm;
pub mod cell;
pub mod code;

mod bank;
mod base;
mod device;
mod fault;
mod force;
mod gripper;
mod io;
mod noise;

pub use bank::{DeviceStatus, MAX_DEVICES, Part, SimBank};
pub use cell::{Cell, CellError, CellErrors};
pub use device::{PortInfo, Report};
pub use fault::{Fault, Trouble};

/// The ports of all kinds of devices: what the manual has to tell.
#[must_use]
pub fn ports() -> Vec<PortInfo> {
    let arms = arm::ports().chain(io::ports());
    let others = base::ports().chain(gripper::ports()).chain(force::ports());
    arms.chain(others).collect()
}
