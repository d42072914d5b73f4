//! Options and errors of a trace replay.

use std::fmt;

use rpi_runtime::ImageLoadError;

/// Options of a trace replay.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Options {
    /// Period in nanoseconds. The corpus was recorded with 25 ms.
    pub period_ns: u64,
    /// Largest deviation of values that count as equal.
    pub tolerance: f64,
    /// Largest deviation of Euler angles and rotations near gimbal lock, where fewer digits are significant.
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

/// Error: a trace cannot be replayed.
#[derive(Clone, PartialEq, Debug)]
pub enum ReplayError {
    /// The trace has no rows and no start time.
    EmptyTrace,
    /// The net has a dependency cycle.
    DependencyCycle,
    /// Lowering of the net failed.
    Lowering(String),
    /// Loading of the image failed.
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
