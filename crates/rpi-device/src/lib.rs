//! Interface between the control cycle and devices: ports that are read, checked, written and called, with values as
//! 64-bit slots.
//!
//! A driver (simulated or real) implements [`Device`] for one device; a bank of all devices of a cell is a
//! [`DeviceBank`], which the core uses. The core resolves names to [`PortId`]s when it loads a command and uses only
//! those afterwards. After that, no method may allocate, lock or wait.
#![no_std]

mod device;
pub mod error_code;

pub use device::{Device, DeviceState, PortIndex, Report};
pub use error_code::ErrorCode;

use core::ops::Range;
use rpi_image::Type;
use rpi_image::image::DevicePort;

/// Number of a device port, which the bank of devices assigns when a command is loaded.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct PortId(pub u32);

/// Kind of a device port: when the control cycle uses it.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum PortKind {
    /// Port that the cycle reads before a command is evaluated.
    Sensor,
    /// Port that the cycle writes, with a set-point, after a command is evaluated.
    Actuator,
    /// Port that a command calls with arguments while it is evaluated, such as inverse kinematics.
    Function,
}

/// Name of a device port, with the kind and type that a command expects.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PortQuery<'a> {
    /// Name of the device in the cell description.
    pub device: &'a str,
    /// Name of the port, for example `joint.commanded_position`, `tcp` or `inverse_kinematics`.
    pub port: &'a str,
    /// Index among several equal ports (axis, input number); 0 if there is only one.
    pub index: u32,
    /// Kind that the port must have: sensor, actuator or function.
    pub kind: PortKind,
    /// Type of the value that the port must have; for a function, type of the result.
    pub ty: Type,
}

impl<'a> PortQuery<'a> {
    /// Makes the query for a port that an image (a compiled command) names; `kind` is the kind that the port must have.
    #[must_use]
    pub fn new(port: &'a DevicePort, kind: PortKind) -> PortQuery<'a> {
        PortQuery {
            device: &port.device,
            port: &port.port,
            index: port.index,
            kind,
            ty: port.ty,
        }
    }
}

/// Reason why the name of a device port cannot be resolved.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ResolveError {
    /// The cell has no device with this name.
    UnknownDevice,
    /// The device has no such port.
    UnknownPort,
    /// The port exists but its index is out of range.
    IndexOutOfRange,
    /// The port has another kind or type than the command expects.
    WrongType,
}

impl core::fmt::Display for ResolveError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            ResolveError::UnknownDevice => "the cell has no such device",
            ResolveError::UnknownPort => "the device has no such port",
            ResolveError::IndexOutOfRange => "the index is out of range",
            ResolveError::WrongType => "the device's port has another kind, type or size",
        })
    }
}

impl core::error::Error for ResolveError {}

/// Reasons of a device to reject a set-point, as a bit set: several can apply.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Rejection(pub u32);

impl Rejection {
    /// Empty set of reasons: the set-point is accepted.
    pub const NONE: Rejection = Rejection(0);
    /// Another writer has already computed a set-point for the same actuator in this cycle.
    pub const CONCURRENT_ACCESS: Rejection = Rejection(1);
    /// The device itself has failed and rejects every set-point.
    pub const DEVICE_FAILED: Rejection = Rejection(2);
    /// The set-point is out of reach, outside its limits, or not a number.
    pub const ILLEGAL_VALUE: Rejection = Rejection(4);
    /// The actuator keeps its value without a set-point, and the program has no port that reports the rejection: the core ends the
    /// command with a fault.
    pub const KEEPS_VALUE: Rejection = Rejection(8);

    /// Returns true if `self` and `other` have a reason in common.
    #[must_use]
    pub const fn intersects(self, other: Rejection) -> bool {
        self.0 & other.0 != 0
    }

    /// Returns the union of both sets of reasons.
    #[must_use]
    pub const fn union(self, other: Rejection) -> Rejection {
        Rejection(self.0 | other.0)
    }
}

/// Quantity of a set-point that violates a limit, computed by backward differences over the period of the set-points.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Quantity {
    /// Position of an actuator, outside its range.
    Position,
    /// Velocity, the first difference of the set-points divided by their period, above its limit.
    Velocity,
    /// Acceleration, the second difference of the set-points divided by the square of their period, above its limit.
    Acceleration,
}

/// Discontinuity: a set-point that does not continue the previous ones within the limits of its device.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Discontinuity {
    /// Number of the resource, such as one axis, whose set-point is discontinuous.
    pub resource: u32,
    /// Quantity that exceeds its limit.
    pub quantity: Quantity,
    /// Value of the quantity that the set-point leads to, in SI units.
    pub value: f64,
    /// Limit of the device for the quantity, in SI units.
    pub limit: f64,
}

/// All devices of a robot cell, as used by the control cycle.
///
/// Values are 64-bit slots in the layout of [`rpi_image::Scalar`]. Every call has bounded time, does not allocate and
/// does not panic.
pub trait DeviceBank {
    /// Finds the port with this name when a command is loaded.
    ///
    /// # Errors
    /// Returns the reason if the cell has no such port.
    fn resolve(&mut self, name: &PortQuery<'_>) -> Result<PortId, ResolveError>;

    /// Returns the number of the resource (actuator) that a port drives; the first one if the port drives several.
    fn resource(&self, port: PortId) -> u32;

    /// Returns the numbers of all resources (actuators) that a port drives. Ports with a common resource exclude each
    /// other. Each joint of an arm is one resource, so a command can set single joints; a port that sets the whole arm
    /// has the resources of all joints.
    fn resources(&self, port: PortId) -> Range<u32> {
        let own = self.resource(port);
        own..own.saturating_add(1)
    }

    /// Prepares a resource when a command that holds it starts. `ticks` is the number of ticks between the set-points
    /// of the command; before the first command it is one. Clears the recorded rejections of set-points of other
    /// commands. A failure of the device remains.
    fn begin_command(&mut self, resource: u32, ticks: u32) {
        let _ = (resource, ticks);
    }

    /// Copies the value that a sensor had at the start of the cycle to `value`. Returns false if there is no sample in
    /// this cycle.
    fn read(&mut self, port: PortId, value: &mut [u64]) -> bool;

    /// Returns the reasons to reject a set-point in this cycle, without writing it.
    fn check_set_point(&mut self, port: PortId, value: &[u64]) -> Rejection;

    /// Returns the first discontinuity between this set-point and the previous ones of the device, with respect to the
    /// device's limits of position, velocity and acceleration; `None` if the set-point continues them, and by default.
    /// The check does not depend on whether the device itself enforces the limits.
    fn discontinuity(&self, port: PortId, value: &[u64]) -> Option<Discontinuity> {
        let _ = (port, value);
        None
    }

    /// Returns the error code of the device to which a port belongs; 0 if there is no error.
    fn error_code(&self, port: PortId) -> i64;

    /// Writes the set-point of this cycle to an actuator port.
    fn write(&mut self, port: PortId, value: &[u64]);

    /// Calls a function of a device with `arguments` and writes its value to `result`. Returns false if the function
    /// has no value for these arguments.
    fn call(&mut self, port: PortId, arguments: &[u64], result: &mut [u64]) -> bool;

    /// Returns true if the resource (actuator) with this number moves. A moving resource needs a set-point in every
    /// cycle.
    fn is_moving(&self, resource: u32) -> bool;

    /// Stops the resource (actuator) with this number: its device brakes within its own limits.
    fn stop(&mut self, resource: u32);

    /// Sets the resource (actuator) with this number to its safe value, if it has one: the command that drove it ended by a
    /// failure, a fault or from outside, and no other command has taken it over. By default, a resource has no safe value.
    fn make_safe(&mut self, resource: u32) {
        let _ = resource;
    }

    /// Sets all resources (actuators) that have a safe value to it: all commands were aborted at once, or no command will drive
    /// them any more. Returns true if an output has changed, so that another step of the devices shows it.
    fn make_all_safe(&mut self) -> bool {
        false
    }
}

/// Device bank of a cell without devices: every port name is unknown.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct NoDevices;

impl DeviceBank for NoDevices {
    fn resolve(&mut self, _: &PortQuery<'_>) -> Result<PortId, ResolveError> {
        Err(ResolveError::UnknownDevice)
    }

    fn resource(&self, port: PortId) -> u32 {
        port.0
    }

    fn read(&mut self, _: PortId, _: &mut [u64]) -> bool {
        false
    }

    fn check_set_point(&mut self, _: PortId, _: &[u64]) -> Rejection {
        Rejection::DEVICE_FAILED
    }

    fn error_code(&self, _: PortId) -> i64 {
        0
    }

    fn write(&mut self, _: PortId, _: &[u64]) {}

    fn call(&mut self, _: PortId, _: &[u64], _: &mut [u64]) -> bool {
        false
    }

    fn is_moving(&self, _: u32) -> bool {
        false
    }

    fn stop(&mut self, _: u32) {}
}
