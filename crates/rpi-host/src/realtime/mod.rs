//! What a cycle on real time asks of the system, and what becomes of cycles that take too long.
//!
//! This module must not know what the cycle does.

mod grant;
mod overrun;

pub use grant::{Grant, Wanted, ask};
pub(crate) use overrun::Verdict;
pub use overrun::{OverrunPolicy, Overruns};
