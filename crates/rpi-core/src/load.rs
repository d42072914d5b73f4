//! Load errors: all reasons why an image cannot run in a cell, not only the first.

use core::fmt;
use rpi_device::{DeviceBank, PortId, PortKind, PortName, ResolveError};
use rpi_image::image::{DevicePort, Image};
use rpi_image::{PrimDesc, VerifyError, verify};
use rpi_prims::PrimId;

use alloc::string::String;
use alloc::vec::Vec;

/// Error when loading an image.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum LoadFault {
    /// The image is malformed.
    Broken(VerifyError),
    /// Unknown device in this cell.
    Device(String),
    /// Unknown port of a device.
    Port {
        /// The port as `device.port[index]: type`.
        port: String,
        /// Use of the port: sensor, actuator or function.
        kind: PortKind,
        /// The error reported by the cell.
        error: ResolveError,
    },
}

impl fmt::Display for LoadFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LoadFault::Broken(error) => write!(f, "invalid image: {error}"),
            LoadFault::Device(device) => write!(f, "the cell has no device `{device}`"),
            LoadFault::Port { port, kind, error } => {
                let reason = match error {
                    // Reported as `LoadFault::Device`, so this arm is not reached.
                    ResolveError::NoDevice => "the cell has no such device",
                    ResolveError::NoPort => "the device has no such port",
                    ResolveError::NoIndex => "the index is out of range",
                    ResolveError::WrongType => "the device's port has another kind, type or size",
                };
                let kind = match kind {
                    PortKind::Sensor => "sensor",
                    PortKind::Actuator => "actuator",
                    PortKind::Function => "function",
                };
                write!(f, "{kind} {port}: {reason}")
            }
        }
    }
}

impl core::error::Error for LoadFault {}

/// Declaration of a primitive of this build by its name, for the verifier.
#[must_use]
pub fn catalogue(name: &str) -> Option<&'static PrimDesc> {
    PrimId::of(name).map(PrimId::desc)
}

/// Verifies an image and returns all verification errors.
pub(crate) fn check(image: &Image) -> Result<(), Vec<LoadFault>> {
    verify(image, &catalogue).map_err(|e| e.into_iter().map(LoadFault::Broken).collect())
}

/// Resolves a port name. Records an error and returns an invalid id if the port does not exist.
pub(crate) fn resolve(
    bank: &mut dyn DeviceBank,
    faults: &mut Vec<LoadFault>,
    port: &DevicePort,
    kind: PortKind,
) -> PortId {
    bank.resolve(&PortName::of(port, kind))
        .unwrap_or_else(|error| {
            let fault = match error {
                ResolveError::NoDevice => LoadFault::Device(port.device.clone()),
                error => LoadFault::Port {
                    port: alloc::format!("{port}"),
                    kind,
                    error,
                },
            };
            // Without this check a missing device would be reported once for each of its ports.
            if !faults.contains(&fault) {
                faults.push(fault);
            }
            PortId(u32::MAX)
        })
}
