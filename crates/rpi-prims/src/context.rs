//! Execution context of a primitive: memory, clocks, devices and faults.

use core::cmp::Ordering;
use rpi_device::DeviceBank;

/// Times of one cycle, equal for all primitives of a command: period, tick, logical time and system time.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct CycleTime {
    /// Time between two cycles of the command, in seconds.
    pub dt: f64,
    /// Duration of a tick of the control core, ns.
    pub tick_ns: u64,
    /// Time between two cycles of the command, in ticks of the control core.
    pub period_ticks: u64,
    /// Number of cycles of the command before this one.
    pub cycle_index: u64,
    /// Logical time of the cycle, ns since the Unix epoch.
    pub net_ns: i64,
    /// Time of the system clock at the start of the cycle, ns since the Unix epoch.
    pub wall_ns: i64,
}

impl CycleTime {
    /// First cycle of a command with a period of 1 ms, at time 0: for primitives that run once, with given operands.
    pub const FIRST: Self = Self {
        dt: 0.001,
        tick_ns: 1_000_000,
        period_ticks: 1,
        cycle_index: 0,
        net_ns: 0,
        wall_ns: 0,
    };

    /// Returns the duration of `ticks` ticks in s, as the nearest real.
    #[must_use]
    pub fn seconds(&self, ticks: i64) -> f64 {
        seconds(ticks, self.tick_ns)
    }

    /// Returns the smallest whole number of ticks that is not shorter than `seconds`. `None` for not-a-number and if
    /// the number of ticks is out of the 64-bit range.
    #[must_use]
    pub fn whole_ticks(&self, seconds: f64) -> Option<i64> {
        checked_whole_ticks(seconds, self.tick_ns)
    }
}

/// Returns the smallest whole number of ticks of `tick_ns` nanoseconds that is not shorter than `seconds`. Numbers out
/// of the 64-bit range saturate: `1e300[s]` means never. Not-a-number becomes 0.
#[must_use]
pub fn whole_ticks(seconds: f64, tick_ns: u64) -> i64 {
    let ends = match seconds.partial_cmp(&0.0) {
        Some(Ordering::Greater) => i64::MAX,
        Some(Ordering::Less) => i64::MIN,
        _ => 0,
    };
    checked_whole_ticks(seconds, tick_ns).unwrap_or(ends)
}

fn checked_whole_ticks(seconds: f64, tick_ns: u64) -> Option<i64> {
    /// Time in ns (2^53) above which a real cannot represent fractions of 1 ns, so that the quotient cannot be
    /// improved.
    const EXACT: f64 = 9_007_199_254_740_992.0;
    /// Largest real below 2^63.
    const MOST: f64 = 9_223_372_036_854_774_784.0;
    let about = libm::floor(seconds * 1e9 / tick_ns as f64);
    if !(-MOST..=MOST).contains(&about) {
        return None;
    }
    let about = about as i64;
    if libm::fabs(seconds * 1e9) > EXACT {
        return Some(about);
    }
    // The quotient is rounded: 1.1 s are 11 ticks of 100 ms, although 1.1 / 0.1 is above 11. So the neighbours are
    // tested.
    let takes = |ticks: &i64| self::seconds(*ticks, tick_ns) >= seconds;
    (about.saturating_sub(2)..=about.saturating_add(2)).find(takes)
}

/// Returns the duration of `ticks` ticks of `tick_ns` nanoseconds in s. The result is the real nearest to the decimal
/// number of seconds.
#[must_use]
pub fn seconds(ticks: i64, tick_ns: u64) -> f64 {
    ticks as f64 * tick_ns as f64 / 1e9
}

/// Cause of a fault (run-time error) of a cycle.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum FaultCode {
    /// Integer result out of the 64-bit range.
    IntegerOverflow,
    /// Integer division or remainder by zero.
    DivisionByZero,
    /// Conversion of a real to an integer: not a number, infinite or out of range.
    LossyConversion,
    /// Array or matrix index out of range.
    IndexOutOfRange,
    /// Array lengths or matrix shapes that do not match.
    ShapeMismatch,
    /// Two writers of one resource in the same cycle.
    ConcurrentAccess,
    /// Missing sample of a sensor that must always have one.
    MissingSample,
    /// Rejected set-point or failed device.
    DeviceFailed,
    /// No set-point for a moving resource; the resource was stopped.
    SetPointMissing,
    /// First set-point after a takeover that does not continue those of the predecessor within the limits of the
    /// device.
    Discontinuity,
    /// Assertion, or clause of a contract, that is false.
    AssertionFailed,
    /// Integer outside its declared subrange.
    OutsideSubrange,
    /// Emergency stop requested by the command.
    EmergencyStop,
}

/// Values that caused a fault, for its message.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FaultValues {
    /// The cause has no values, or they are not known.
    Unknown,
    /// Index that is out of range, and the number of elements.
    Index {
        /// Index that was out of bounds, from 0.
        index: i64,
        /// Number of elements of the array, or of rows or columns of the matrix.
        length: i64,
    },
    /// Integer that is out of range, and the range that must contain it.
    Range {
        /// Integer that lies outside of its subrange.
        value: i64,
        /// Lowest value of the range.
        from: i64,
        /// Highest value of the range.
        to: i64,
    },
    /// Real number that cannot be converted.
    Real {
        /// Bits of the real number, as of [`f64::from_bits`].
        bits: u64,
    },
}

/// First fault (run-time error) of a cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Fault {
    /// Cause of the fault, such as a division by zero.
    pub code: FaultCode,
    /// Numbers for the message, such as the index and the size of the array; [`FaultValues::Unknown`] for most codes.
    pub values: FaultValues,
    /// First output slot of the primitive that raised the fault. The image (the compiled command) maps the slot to a
    /// source location.
    pub slot: u32,
}

impl Fault {
    /// Creates a fault at a memory slot of the command, with a cause that has no values.
    #[must_use]
    pub const fn new(code: FaultCode, slot: u32) -> Fault {
        Fault {
            code,
            values: FaultValues::Unknown,
            slot,
        }
    }
}

/// Execution context of a call of a primitive: memory, times and devices.
pub struct Context<'a> {
    /// All memory slots of the command.
    pub slots: &'a mut [u64],
    /// Times of the cycle: period, tick, logical time and system time.
    pub time: CycleTime,
    /// Devices of the robot cell, for primitives that access them.
    pub devices: &'a mut dyn DeviceBank,
    /// First fault of the cycle so far; `None` without a fault.
    pub fault: Option<Fault>,
}

impl Context<'_> {
    /// Records a fault at the memory slot `cell`, unless the cycle already has one. The cycle continues, and its
    /// set-points are discarded.
    #[cold]
    pub fn fault(&mut self, code: FaultCode, cell: u32) {
        self.fault.get_or_insert(Fault::new(code, cell));
    }

    /// Records a fault at the memory slot `cell` with the values that caused it, unless the cycle already has a fault.
    #[cold]
    pub fn fault_by(&mut self, code: FaultCode, cell: u32, values: FaultValues) {
        self.fault.get_or_insert(Fault {
            code,
            values,
            slot: cell,
        });
    }
}
