//! Load errors: all reasons why an image cannot run in a cell, not only the first.

use core::fmt;
use rpi_device::{DeviceBank, PortId, PortKind, PortQuery, ResolveError};
use rpi_image::external::EXTERNAL_DEVICE;
use rpi_image::image::{DevicePort, Image};
use rpi_image::{PrimDesc, VerifyError, verify};
use rpi_prims::PrimId;

use alloc::string::String;
use alloc::vec::Vec;

/// Reason why an image (a compiled command) cannot be loaded in a cell.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum LoadError {
    /// The verifier rejects the image, because of this error.
    InvalidImage(VerifyError),
    /// The image names a device, given here, that the cell does not have.
    UnknownDevice(String),
    /// The image calls an external function, given here by its name in C, and nothing provides it.
    ExternalFunction(String),
    /// The image names a device port that the cell does not have, or has with another kind or type.
    UnknownPort {
        /// Port of the image, as the text `device.port[index]: type`.
        port: String,
        /// Use of the port by the image: sensor, actuator or function.
        kind: PortKind,
        /// The error reported by the cell.
        error: ResolveError,
    },
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LoadError::InvalidImage(error) => write!(f, "invalid image: {error}"),
            LoadError::UnknownDevice(device) => write!(f, "the cell has no device `{device}`"),
            LoadError::ExternalFunction(symbol) => write!(
                f,
                "nothing computes the external function `{symbol}`: it is a function in C"
            ),
            LoadError::UnknownPort { port, kind, error } => {
                let kind = match kind {
                    PortKind::Sensor => "sensor",
                    PortKind::Actuator => "actuator",
                    PortKind::Function => "function",
                };
                write!(f, "{kind} {port}: {error}")
            }
        }
    }
}

impl core::error::Error for LoadError {}

/// Returns the declaration of the primitive (basic operation) with this name, for the verifier; `None` if this build
/// does not have it.
#[must_use]
pub fn prim_desc(name: &str) -> Option<&'static PrimDesc> {
    PrimId::from_name(name).map(PrimId::desc)
}

/// Verifies an image, which is untrusted input, before it is loaded. Returns all verification errors.
pub(crate) fn verify_image(image: &Image) -> Result<(), Vec<LoadError>> {
    verify(image, &prim_desc).map_err(|e| e.into_iter().map(LoadError::InvalidImage).collect())
}

/// Resolves a port of an image in the cell. If the cell lacks the port, appends an error to `faults` and returns an
/// invalid id.
pub(crate) fn resolve_port(
    bank: &mut dyn DeviceBank,
    faults: &mut Vec<LoadError>,
    port: &DevicePort,
    kind: PortKind,
) -> PortId {
    bank.resolve(&PortQuery::new(port, kind))
        .unwrap_or_else(|error| {
            let fault = match error {
                _ if port.device == EXTERNAL_DEVICE => {
                    LoadError::ExternalFunction(port.port.clone())
                }
                ResolveError::UnknownDevice => LoadError::UnknownDevice(port.device.clone()),
                error => LoadError::UnknownPort {
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
