//! Options and errors of a trace replay.

use std::fmt;

use rpi_runtime::ImageLoadError;

/// Options of the replay of a net against a trace.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Options {
    /// Period of the net in nanoseconds. The default of 25 ms is the period of the authors' recorded traces.
    pub period_ns: u64,
    /// Largest deviation of values that count as equal: absolute for values up to 1, relative for larger ones.
    pub tolerance: f64,
    /// Largest deviation in radians of Euler angles and rotations near gimbal lock that counts as equal; fewer digits
    /// are significant there.
    pub gimbal_lock_tolerance: f64,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            period_ns: 25_000_000,
            tolerance: 1e-9,
            gimbal_lock_tolerance: 1e-6,
        }
    }
}

/// Error: a net cannot be replayed against a trace.
#[derive(Clone, PartialEq, Debug)]
pub enum ReplayError {
    /// The trace has no rows and no start time.
    EmptyTrace,
    /// The net has a dependency cycle: flows that depend on one another in the same cycle.
    DependencyCycle,
    /// The net cannot be lowered to an image; the text is the reason.
    Lowering(String),
    /// The control core rejects the image of the net, for these reasons.
    Loading(ImageLoadError),
}

impl fmt::Display for ReplayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ReplayError::EmptyTrace => f.write_str("the trace is empty"),
            ReplayError::DependencyCycle => f.write_str("the net has a dependency cycle"),
            ReplayError::Lowering(reason) => write!(f, "the net cannot be lowered: {reason}"),
            ReplayError::Loading(reasons) => write!(f, "the net cannot be loaded: {reasons}"),
        }
    }
}

impl std::error::Error for ReplayError {}
