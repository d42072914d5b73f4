//! How a replay is done, and why one could not be done.

use std::fmt;

use rpi_core::LoadFault;

/// How a replay is done.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Options {
    /// Period in nanoseconds; the corpus was recorded at 25 ms.
    pub period_ns: u64,
    /// How far apart equal values may be.
    pub tolerance: f64,
    /// How far apart Euler angles and rotations may be near gimbal lock, where their digits are worth less.
    pub lock_tolerance: f64,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            period_ns: 25_000_000,
            tolerance: 1e-9,
            lock_tolerance: 1e-6,
        }
    }
}

/// Why a replay could not be done at all.
#[derive(Clone, PartialEq, Debug)]
pub enum ReplayError {
    /// The trace holds nothing, not even a start time.
    Empty,
    /// Something in the net depends on itself.
    Cyclic,
    /// The net cannot be lowered.
    Lowering(String),
    /// The image cannot be loaded.
    Loading(Vec<LoadFault>),
}

impl fmt::Display for ReplayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ReplayError::Empty => f.write_str("the trace is empty"),
            ReplayError::Cyclic => f.write_str("something in the net depends on itself"),
            ReplayError::Lowering(reason) => write!(f, "the net cannot be lowered: {reason}"),
            ReplayError::Loading(faults) => {
                let reasons: Vec<String> = faults.iter().map(ToString::to_string).collect();
                write!(f, "the net cannot be loaded: {}", reasons.join("; "))
            }
        }
    }
}

impl std::error::Error for ReplayError {}
