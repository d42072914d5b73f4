//! What a primitive sees while it runs.

use core::cmp::Ordering;
use rpi_device::DeviceBank;

/// The clocks of one cycle; the same for all primitives in it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Clock {
    /// Period in seconds.
    pub dt: f64,
    /// Length of a tick, nanoseconds: what values of the type `time` count.
    pub tick_ns: u64,
    /// Number of ticks in a period.
    pub ticks: u64,
    /// Number of the command's cycle, from 0.
    pub cycle: u64,
    /// Logical time of this cycle, nanoseconds since the Unix epoch.
    pub net_ns: i64,
    /// The machine's clock at the start of the cycle, nanoseconds since the Unix epoch.
    pub wall_ns: i64,
}

impl Clock {
    /// The seconds that so many ticks take: the nearest real, as a decimal number of seconds is read.
    #[must_use]
    pub fn seconds(&self, ticks: i64) -> f64 {
        seconds(ticks, self.tick_ns)
    }

    /// The fewest whole ticks that take at least so many seconds; none for not-a-number and what 64 bits do not hold.
    #[must_use]
    pub fn whole_ticks(&self, seconds: f64) -> Option<i64> {
        counted(seconds, self.tick_ns)
    }
}

/// The fewest whole ticks of so many nanoseconds that take at least so many seconds. What 64 bits do not hold is the longest time that
/// they hold: `1e300[s]` stands for never. Not-a-number is 0.
#[must_use]
pub fn whole_ticks(seconds: f64, tick_ns: u64) -> i64 {
    let ends = match seconds.partial_cmp(&0.0) {
        Some(Ordering::Greater) => i64::MAX,
        Some(Ordering::Less) => i64::MIN,
        _ => 0,
    };
    counted(seconds, tick_ns).unwrap_or(ends)
}

fn counted(seconds: f64, tick_ns: u64) -> Option<i64> {
    /// Above, a real holds no fraction of a nanosecond, and the quotient below is as good as it gets.
    const EXACT: f64 = 9_007_199_254_740_992.0;
    /// Below 2^63, and a real.
    const MOST: f64 = 9_223_372_036_854_774_784.0;
    let about = libm::floor(seconds * 1e9 / tick_ns as f64);
    if !(-MOST..=MOST).contains(&about) {
        return None;
    }
    let about = about as i64;
    if libm::fabs(seconds * 1e9) > EXACT {
        return Some(about);
    }
    // The quotient is rounded: 1.1 s are 11 ticks of 100 ms although 1.1 / 0.1 is above 11.
    let takes = |ticks: &i64| self::seconds(*ticks, tick_ns) >= seconds;
    (about.saturating_sub(2)..=about.saturating_add(2)).find(takes)
}

/// The seconds that so many ticks of so many nanoseconds take: the nearest real, as a decimal number of seconds is read.
#[must_use]
pub fn seconds(ticks: i64, tick_ns: u64) -> f64 {
    ticks as f64 * tick_ns as f64 / 1e9
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
