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

mod bank;
mod base;
mod device;
mod driver_io;
mod fault;
mod io;
mod kinds;
mod noise;
pub mod rtde;
pub mod udp;

pub use bank::{DeviceStatus, MAX_DEVICES, NamedDevice, OpenError, SimBank};
pub use cell::{
    Cell, CellError, CellErrors, PointsFile, TaughtPoint, TaughtPose, Tool, WorkFrame, robot,
};
pub use device::PortInfo;
pub use fault::{FaultKind, ScheduledFault};
pub use kinds::{KeyInfo, Settings, SmallKind, SmallSpec};
pub use rpi_device::{Report, error_code};
