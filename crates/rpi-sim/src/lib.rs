//! Simulated devices and cell descriptions.
//!
//! [`Cell`] is a parsed `cell.toml`; [`SimBank`] holds the devices that it describes. The host calls [`SimBank::step`]
//! once per tick, after all commands have sent their set-points. The simulation is deterministic: it depends only on
//! the cell, the set-points and the number of ticks. It uses no clock and only seeded noise, and a tick does not
//! allocate.
//!
//! This crate does not depend on commands, nets or programs.

pub mod arm;
pub mod cell;
pub mod error_code;

mod bank;
mod base;
mod device;
mod fault;
mod force;
mod gripper;
mod io;
mod noise;

pub use bank::{DeviceStatus, MAX_DEVICES, NamedDevice, SimBank};
pub use cell::{Cell, CellError, CellErrors};
pub use device::{PortInfo, Report};
pub use fault::{FaultKind, ScheduledFault};

/// Port descriptions of all device types, for the manual.
#[must_use]
pub fn ports() -> Vec<PortInfo> {
    let arms = arm::ports().chain(io::ports());
    let others = base::ports().chain(gripper::ports()).chain(force::ports());
    arms.chain(others).collect()
}
