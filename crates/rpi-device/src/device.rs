//! Interface of one device.

use crate::{Discontinuity, ErrorCode, PortQuery, Rejection, ResolveError};
use core::ops::Range;

/// Address of a port within one device: a row of the device's table of ports, and an index within the row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PortIndex {
    /// Row of the device's table of ports, from 0 to 255.
    pub row: u16,
    /// Index among the equal ports of the row, such as the number of an axis or terminal, from 0; 0 if the row has one
    /// port.
    pub index: u16,
}

/// Ability of a device to follow set-points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DeviceState {
    /// The device follows set-points.
    Ready,
    /// The device brakes by itself, because set-points are missing or a command left it moving.
    Braking,
    /// The device has failed or is not connected: it rejects all set-points.
    Failed,
}

/// One device of a cell, simulated or real, as the control cycle uses it.
///
/// A device has its own clock, state, error codes and resources. The resources are numbered from 0 within the device: a
/// resource is what one command holds alone, such as an axis. Values are slots in the layout of [`rpi_image::Scalar`], in
/// SI units. Every method has bounded time, does not allocate, lock, wait or panic, and gives the same bits for the same
/// calls. A driver exchanges data with its controller on a thread of its own, which [`step`](Self::step) reaches
/// through memory.
pub trait Device: Send {
    /// Finds a port by name, kind, type and index.
    ///
    /// # Errors
    /// Returns the reason if the device has no such port, or has it with another kind or type.
    fn resolve(&self, name: &PortQuery<'_>) -> Result<PortIndex, ResolveError>;

    /// Returns true if the port exists. The core calls the other methods only with existing ports.
    fn has_port(&self, port: PortIndex) -> bool;

    /// Returns the numbers of the resources of an actuator port, counted within the device; empty for other ports.
    fn resources(&self, port: PortIndex) -> Range<u32>;

    /// Copies the present value of a sensor to `value`, as 64-bit slots. Returns false if the sensor has no value in
    /// this cycle.
    fn read(&self, port: PortIndex, value: &mut [u64]) -> bool;

    /// Checks a set-point for an actuator before it is written and returns the reasons to reject it. The method is also
    /// called for set-points that are never written: only error codes of the device may change.
    fn check(&mut self, port: PortIndex, value: &[u64]) -> Rejection;

    /// Returns the discontinuity between a set-point and the present motion of the device; `None` if the set-point
    /// continues the motion. The number of the resource in the discontinuity counts within the device.
    fn discontinuity(&self, port: PortIndex, value: &[u64]) -> Option<Discontinuity> {
        let _ = (port, value);
        None
    }

    /// Returns the error code of that part of the device, such as one joint, to which a port belongs.
    fn port_code(&self, port: PortIndex) -> ErrorCode;

    /// Passes a checked set-point to an actuator. The device applies it in the next [`step`](Self::step).
    fn write(&mut self, port: PortIndex, value: &[u64]);

    /// Calls the function of the device behind `port` with `arguments` and writes its value to `result`. Returns false
    /// if the function has no value for these arguments.
    fn call(&mut self, port: PortIndex, arguments: &[u64], result: &mut [u64]) -> bool {
        let _ = (port, arguments, result);
        false
    }

    /// Returns true if the resource with this number moves. A moving resource needs a set-point in every cycle.
    fn is_moving(&self, resource: u32) -> bool {
        let _ = resource;
        false
    }

    /// Stops a resource that no command drives any more: the device brakes within its own limits, on its path where
    /// possible.
    fn stop(&mut self, resource: u32) {
        let _ = resource;
    }

    /// Sets a resource to its safe value, if the cell gives it one: the command that drove it has failed, and no other
    /// one has taken it over. By default, a resource has no safe value.
    fn make_safe(&mut self, resource: u32) {
        let _ = resource;
    }

    /// Prepares a resource for a command whose set-points come every `ticks` ticks of the cell.
    fn begin_command(&mut self, resource: u32, ticks: u32) {
        let _ = (resource, ticks);
    }

    /// Ends one tick of the cell at `time` (s, on the clock of the cell): passes on the set-points of the tick, and
    /// stores the samples that sensors have in the next tick. A device without set-points for longer than its watchdog
    /// allows begins to brake here.
    fn step(&mut self, time: f64);

    /// Returns the error code that the device has now.
    fn code(&self) -> ErrorCode {
        ErrorCode::OK
    }

    /// Returns the ability of the device to follow set-points. By default, the state follows from the error code.
    fn state(&self) -> DeviceState {
        match self.code() {
            code if code.is_failure() => DeviceState::Failed,
            ErrorCode::SET_POINT_MISSING | ErrorCode::BRAKING => DeviceState::Braking,
            _ => DeviceState::Ready,
        }
    }

    /// Returns the time of the device's own clock at its present samples, in s; `None` if it uses the clock of the cell.
    fn clock(&self) -> Option<f64> {
        None
    }

    /// Calls `each` with every report since the previous call. Returns the number of reports lost for lack of space.
    fn reports(&mut self, each: &mut dyn FnMut(Report)) -> u64 {
        let _ = each;
        0
    }
}

/// Report of a device about a rejected set-point or a failure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Time of the report on the clock of the cell, in s.
    pub time: f64,
    /// Number of the axis, from 0; `None` if the report concerns the whole device.
    pub axis: Option<usize>,
    /// Error code of the rejection or failure; 0 for none.
    pub code: ErrorCode,
    /// The rejected value, in SI units; 0 if not applicable.
    pub value: f64,
    /// The violated limit, in SI units; 0 if not applicable.
    pub limit: f64,
}
