//! Error of the functions that run nets for benchmarks and tests.

use std::fmt;

/// Reason why a net could not be run, or the first difference between two runs.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BenchError {
    message: String,
}

impl BenchError {
    /// An error with this message.
    #[must_use]
    pub fn new(message: impl Into<String>) -> Self {
        BenchError {
            message: message.into(),
        }
    }

    /// An error with the text of its cause.
    pub(crate) fn from_cause(cause: impl fmt::Display) -> Self {
        BenchError::new(cause.to_string())
    }
}

impl fmt::Display for BenchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for BenchError {}
