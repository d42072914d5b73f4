//! The clock that a cycle follows, what it asks of the system, and what becomes of cycles that take too long.
//!
//! This module must not know what the cycle does.

mod beat;
mod clock;
mod fence;
mod figures;
mod grant;
mod overrun;

pub use beat::Beat;
pub use clock::Pace;
pub use fence::fence;
pub use figures::{Figures, Spread};
pub use grant::{Grant, Wanted, ask};
pub use overrun::{OverrunPolicy, Overruns};

/// What is asked of the system on real time, and what happens to cycles that take too long there.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct RealTime {
    /// For the thread that ticks.
    pub wanted: Wanted,
    /// After a cycle that ended when the next one was due already.
    pub overrun: OverrunPolicy,
    /// Whether the thread that ticks may make no system call but those of the clock: see [`fence()`].
    pub fence: bool,
}
