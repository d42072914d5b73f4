//! Error of the prover when facts contradict each other.

use std::fmt;

/// Error for facts that contradict each other.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct ContradictionError;

impl fmt::Display for ContradictionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("contradictory facts")
    }
}

impl std::error::Error for ContradictionError {}
