//! Counters of what the server has done since its start, for monitoring.

use rpi_runtime::control::{Cause, Ending};

/// Counters since the start of the server. They only grow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Statistics {
    /// Number of commands and tasks that were loaded.
    pub(crate) loads_accepted: u64,
    /// Number of commands and tasks that could not be loaded.
    pub(crate) loads_rejected: u64,
    /// Number of requests that the cycle has carried out.
    pub(crate) requests_done: u64,
    /// Number of requests that the cycle has refused.
    pub(crate) requests_refused: u64,
    /// Number of takeovers with a discontinuity of a set-point.
    pub(crate) discontinuities: u64,
    /// Number of requests for an emergency stop.
    pub(crate) emergency_stops: u64,
    /// Number of ended commands by cause, in the order of [`CAUSES`].
    ended: [u64; CAUSES.len()],
}

/// Names of the causes for which commands end.
const CAUSES: [&str; 5] = ["result", "terminate", "fault", "aborted", "stopped"];

/// Returns the index of a cause in [`CAUSES`].
fn index(cause: &Cause) -> usize {
    match cause {
        Cause::Result(_) => 0,
        Cause::Terminate => 1,
        Cause::Fault(_) => 2,
        Cause::Aborted(_) => 3,
        Cause::Stopped(_) => 4,
    }
}

impl Statistics {
    /// Counts a command that has ended.
    pub(super) fn count_ending(&mut self, ending: &Ending) {
        self.ended[index(&ending.cause)] += 1;
    }

    /// Returns the number of ended commands with the name of each cause.
    pub(crate) fn ended(&self) -> impl Iterator<Item = (&'static str, u64)> {
        CAUSES.into_iter().zip(self.ended)
    }
}
