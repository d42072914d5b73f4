//! Error of the functions that run nets for benchmarks and tests.

use std::fmt;

/// Reason why a benchmark could not run a net, or description of the first difference between two runs.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BenchError {
    message: String,
}

impl BenchError {
    /// Creates an error whose text is `message`.
    #[must_use]
    pub fn new(message: impl Into<String>) -> Self {
        BenchError {
            message: message.into(),
        }
    }

    /// Creates an error with the text of another error.
    pub fn from_cause(cause: impl fmt::Display) -> Self {
        BenchError::new(cause.to_string())
    }
}

impl fmt::Display for BenchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for BenchError {}
