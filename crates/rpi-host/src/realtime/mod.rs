//! The clock that a cycle follows, what it asks of the system, and what becomes of cycles that take too long.
//!
//! This module must not know what the cycle does.

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

/// What is asked of the system on real time, and what happens to cycles that take too long there.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct RealTime {
    /// For the thread that ticks.
    pub wanted: Wanted,
    /// After a cycle that ended when the next one was due already.
    pub overrun: OverrunPolicy,
    /// What becomes of the command that took the longest in such a cycle, where it was loaded without a policy of its own.
    pub commands: OnOverrun,
    /// Whether the thread that ticks may make no system call but those of the clock: see [`fence()`].
    pub fence: bool,
}

/// Asks the system for all of this for the calling thread, and puts up the fence if there is to be one. What a thread behind a
/// fence does in the end is to [`rest()`].
#[must_use]
pub fn begin(real_time: RealTime) -> Vec<Grant> {
    let mut grants = ask(real_time.wanted);
    grants.extend(real_time.fence.then(fence));
    grants
}
