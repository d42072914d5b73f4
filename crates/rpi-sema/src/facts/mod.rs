//! What is found out about typed units beside their types, in tables of its own: by which clocks flows tick, and which
//! can be absent.
//!
//! A pass is a function from units to facts and findings; it must not change the units.

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
