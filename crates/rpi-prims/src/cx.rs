//! What a primitive sees while it runs.

use rpi_device::DeviceBank;

/// The clocks of one cycle; the same for all primitives in it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Clock {
    /// Period in seconds.
    pub dt: f64,
    /// Number of the command's cycle, from 0.
    pub cycle: u64,
    /// Logical time of this cycle, nanoseconds since the Unix epoch.
    pub net_ns: i64,
    /// The machine's clock at the start of the cycle, nanoseconds since the Unix epoch.
    pub wall_ns: i64,
}

/// Why a cycle could not be computed.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum FaultCode {
    /// A result does not fit a 64-bit integer.
    IntegerOverflow,
    /// Integer division or remainder by zero.
    DivisionByZero,
    /// A real has no integer value: not a number, infinite or out of range.
    LossyConversion,
    /// An index lies outside its array.
    IndexOutOfRange,
    /// Matrices or arrays whose shapes do not fit.
    ShapeMismatch,
    /// Two writers of one actuator in a cycle.
    ConcurrentAccess,
    /// A total sensor had no sample.
    MissingSample,
    /// A device refuses its set-point or has failed.
    DeviceFailed,
    /// A moving actuator got no set-point and was stopped.
    SetPointMissing,
    /// The first set-point after a switch does not join those before it.
    Discontinuity,
    /// An assertion or contract does not hold.
    AssertionFailed,
    /// A value lies outside of the subrange that it is declared to lie in.
    OutsideSubrange,
    /// The command itself has asked for an emergency stop.
    EmergencyStop,
}

/// The first fault of a cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Fault {
    /// What happened.
    pub code: FaultCode,
    /// First output cell of the primitive to which it happened; the image maps it to a place.
    pub cell: u32,
}

/// Memory, clocks and devices, lent to a primitive for one call.
pub struct Cx<'a> {
    /// All cells of the command.
    pub cells: &'a mut [u64],
    /// The clocks of this cycle.
    pub clock: Clock,
    /// The devices.
    pub devices: &'a mut dyn DeviceBank,
    /// The first fault of this cycle.
    pub fault: Option<Fault>,
}

impl Cx<'_> {
    /// Records a fault unless one is already known; the cycle goes on and its set-points are dropped.
    #[cold]
    pub fn fault(&mut self, code: FaultCode, cell: u32) {
        self.fault.get_or_insert(Fault { code, cell });
    }
}
