//! Error of the prover when facts contradict each other.

use std::fmt;

/// Error: facts about a cycle contradict each other, so that no such cycle exists.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct ContradictionError;

impl fmt::Display for ContradictionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("contradictory facts")
    }
}

impl std::error::Error for ContradictionError {}
