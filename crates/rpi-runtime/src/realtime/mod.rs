//! Tick clock, real-time resources of the tick thread, and overrun handling.
//!
//! This module must not depend on what the cycle computes.

mod beat;
mod clock;
mod fence;
mod figures;
mod grant;
mod overrun;
mod stopwatch;

pub use beat::Beat;
pub use clock::Pace;
pub use fence::{fence, is_fence_up, rest};
pub use figures::{Figures, Spread};
pub use grant::{Grant, Wanted, ask};
pub use overrun::{OverrunPolicy, Overruns};
pub use rpi_core::{Often, OnOverrun};
pub(crate) use stopwatch::Stopwatch;

/// Options of real-time execution.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct RealTime {
    /// Scheduling resources requested for the tick thread.
    pub wanted: Wanted,
    /// Policy for ticks that end after the next one was due.
    pub overrun: OverrunPolicy,
    /// Overrun policy of commands that were loaded without one. It applies to the command that took the longest in an
    /// overrun tick.
    pub commands: OnOverrun,
    /// Whether the tick thread is restricted to the system calls of the clock; see [`fence()`].
    pub fence: bool,
}

/// Requests all of these resources for the calling thread and installs the system call filter if it is enabled.
///
/// A thread with the filter must call [`rest()`] in the end.
#[must_use]
pub fn begin(real_time: RealTime) -> Vec<Grant> {
    let mut grants = ask(real_time.wanted);
    grants.extend(real_time.fence.then(fence));
    grants
}
