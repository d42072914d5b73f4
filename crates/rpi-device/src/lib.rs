//! What the cycle sees of devices: ports that are read, checked, written and called, on plain cells.
//!
//! A driver (simulated or real) implements [`DeviceBank`]; the core resolves names to [`PortId`]s when a command is
//! loaded and uses only those afterwards. Nothing here may allocate, lock or wait once resolved.
#![no_std]

use core::ops::Range;
use rpi_image::Type;
use rpi_image::image::DevicePort;

/// A port of a device, resolved when a command is loaded.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct PortId(pub u32);

/// What a port is for.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum PortKind {
    /// Read before evaluation.
    Sensor,
    /// Written after evaluation.
    Actuator,
    /// Called during evaluation.
    Function,
}

/// The name of a port as a command asks for it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PortName<'a> {
    /// Device, as the cell description names it.
    pub device: &'a str,
    /// Port of the device, `joint.commanded_position`, `tcp`, `inverse_kinematics`.
    pub port: &'a str,
    /// Which of several equal ones: axis, input number; 0 where there is one.
    pub index: u32,
    /// What it is used for.
    pub kind: PortKind,
    /// Type of the value; of the result for functions.
    pub ty: Type,
}

impl<'a> PortName<'a> {
    /// The name by which an image's port is asked for.
    #[must_use]
    pub fn of(port: &'a DevicePort, kind: PortKind) -> PortName<'a> {
        PortName {
            device: &port.device,
            port: &port.port,
            index: port.index,
            kind,
            ty: port.ty,
        }
    }
}

/// Why a name did not resolve.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ResolveError {
    /// No device of this name in the cell.
    NoDevice,
    /// The device has no such port.
    NoPort,
    /// The port exists but its index is out of range.
    NoIndex,
    /// The port is of another kind or type.
    WrongType,
}

/// What a device says to a set-point before it is accepted; bits, so that several can be true.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Refusal(pub u32);

impl Refusal {
    /// Nothing against it.
    pub const NONE: Refusal = Refusal(0);
    /// Another writer has set this port in the same cycle.
    pub const CONCURRENT_ACCESS: Refusal = Refusal(1);
    /// The device has failed.
    pub const DEVICE_FAILED: Refusal = Refusal(2);
    /// The value is not reachable, out of limits or not a number.
    pub const ILLEGAL_VALUE: Refusal = Refusal(4);

    /// True if any of `other`'s bits is set.
    #[must_use]
    pub const fn has(self, other: Refusal) -> bool {
        self.0 & other.0 != 0
    }

    /// Both together.
    #[must_use]
    pub const fn and(self, other: Refusal) -> Refusal {
        Refusal(self.0 | other.0)
    }
}

/// What does not join where a set-point follows another one: by backward differences over the actuator's period.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Quantity {
    /// The position leaves its range.
    Position,
    /// The first difference.
    Velocity,
    /// The second difference.
    Acceleration,
}

/// A set-point that does not join those before it within the limits of its device.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Jump {
    /// The actuator.
    pub resource: u32,
    /// What breaks its limit.
    pub quantity: Quantity,
    /// Its value with this set-point; SI units.
    pub value: f64,
    /// The limit of the device; SI units.
    pub limit: f64,
}

/// All devices of a cell, as the cycle sees them.
///
/// Values are cells as [`rpi_image::Scalar`] lays them out. Every call is bounded, allocation-free and cannot panic.
pub trait DeviceBank {
    /// Resolves a name when a command is loaded.
    ///
    /// # Errors
    /// Says why the cell has no such port.
    fn resolve(&mut self, name: &PortName<'_>) -> Result<PortId, ResolveError>;

    /// The actuator (resource) that a port belongs to, the first one where it belongs to several.
    fn resource(&self, port: PortId) -> u32;

    /// All actuators that a port belongs to: ports with a number in common exclude one another. The joints of an arm are
    /// one actuator each, so that one command can set them one by one; a port that sets the whole arm belongs to all.
    fn resources(&self, port: PortId) -> Range<u32> {
        let own = self.resource(port);
        own..own.saturating_add(1)
    }

    /// Tells that a command begins that holds an actuator, and how many ticks lie between its set-points, from the next one
    /// on: a device that was never told expects one in every tick. What the device had against the set-points of others is
    /// not this command's concern; that it has failed is.
    fn begin(&mut self, resource: u32, ticks: u32) {
        let _ = (resource, ticks);
    }

    /// Latches a sensor's value; false if there is no sample in this cycle.
    fn read(&mut self, port: PortId, value: &mut [u64]) -> bool;

    /// Asks whether a set-point would be accepted now, without handing it over.
    fn check(&mut self, port: PortId, value: &[u64]) -> Refusal;

    /// Where this set-point would not join those that the device was given before, within its limits of position,
    /// velocity and acceleration; whether the device enforces them itself does not matter.
    fn jump(&self, port: PortId, value: &[u64]) -> Option<Jump> {
        let _ = (port, value);
        None
    }

    /// Error code of the device behind a port; 0 if it is well.
    fn error(&self, port: PortId) -> i64;

    /// Hands a set-point over for this cycle.
    fn write(&mut self, port: PortId, value: &[u64]);

    /// Calls a function of a device; false if it has no result for these arguments.
    fn call(&mut self, port: PortId, arguments: &[u64], result: &mut [u64]) -> bool;

    /// True while an actuator moves, so that nobody may leave it without a set-point.
    fn moving(&self, resource: u32) -> bool;

    /// Lets the device bring itself to a stop on its own limits.
    fn stop(&mut self, resource: u32);
}

/// A cell without devices.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct NoDevices;

impl DeviceBank for NoDevices {
    fn resolve(&mut self, _: &PortName<'_>) -> Result<PortId, ResolveError> {
        Err(ResolveError::NoDevice)
    }

    fn resource(&self, port: PortId) -> u32 {
        port.0
    }

    fn read(&mut self, _: PortId, _: &mut [u64]) -> bool {
        false
    }

    fn check(&mut self, _: PortId, _: &[u64]) -> Refusal {
        Refusal::DEVICE_FAILED
    }

    fn error(&self, _: PortId) -> i64 {
        0
    }

    fn write(&mut self, _: PortId, _: &[u64]) {}

    fn call(&mut self, _: PortId, _: &[u64], _: &mut [u64]) -> bool {
        false
    }

    fn moving(&self, _: u32) -> bool {
        false
    }

    fn stop(&mut self, _: u32) {}
}
