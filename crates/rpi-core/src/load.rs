//! Loading: every reason why an image cannot run here, not only the first.

use core::fmt;
use rpi_device::{DeviceBank, PortId, PortKind, PortName, ResolveError};
use rpi_image::image::{DevicePort, Image};
use rpi_image::{PrimDesc, VerifyError, verify};
use rpi_prims::PrimId;

use alloc::string::String;
use alloc::vec::Vec;

/// Why an image was not loaded.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum LoadFault {
    /// The image does not hold what it must hold.
    Broken(VerifyError),
    /// The cell has no such device.
    Device(String),
    /// The device has no such port.
    Port {
        /// `device.port[index]: type`.
        port: String,
        /// What it is used for.
        kind: PortKind,
        /// What the cell says.
        error: ResolveError,
    },
}

impl fmt::Display for LoadFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LoadFault::Broken(error) => write!(f, "broken image: {error}"),
            LoadFault::Device(device) => write!(f, "the cell has no device `{device}`"),
            LoadFault::Port { port, kind, error } => {
                let reason = match error {
                    // Told as a fault of its own.
                    ResolveError::NoDevice => "the cell has no such device",
                    ResolveError::NoPort => "the device has no such port",
                    ResolveError::NoIndex => "the device has not so many",
                    ResolveError::WrongType => "the device has it of another kind, type or size",
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

/// The declarations of this build, as the verifier asks for them.
#[must_use]
pub fn catalogue(name: &str) -> Option<&'static PrimDesc> {
    PrimId::of(name).map(PrimId::desc)
}

/// Verifies an image.
pub(crate) fn check(image: &Image) -> Result<(), Vec<LoadFault>> {
    verify(image, &catalogue).map_err(|e| e.into_iter().map(LoadFault::Broken).collect())
}

/// Resolves a name, or notes why not and gives a port that is never used.
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
            // One missing device would else be told for each of its ports.
            if !faults.contains(&fault) {
                faults.push(fault);
            }
            PortId(u32::MAX)
        })
}
