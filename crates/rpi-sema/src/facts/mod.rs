//! Analyses of typed units whose results are stored beside the units: the clocks of flows, and which flows can be
//! absent.
//!
//! A pass is a function from units to facts and diagnostics. It must not change the units.

mod absence;
mod demand;
mod exclusive;
mod handed;
mod presence;
mod reads;

pub use absence::Absence;
pub(crate) use exclusive::literal;
pub use presence::{Facts, find};
pub(crate) use reads::{Definition, Reads};
