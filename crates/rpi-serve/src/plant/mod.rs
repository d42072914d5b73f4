//! The real-time side: the core and the devices on a thread of their own, reached only through bounded queues.

mod board;
mod clock;
mod cycle;
mod links;

pub(crate) use board::{Board, values};
pub(crate) use clock::Clock;
pub use clock::Pace;
pub(crate) use cycle::Cycle;
pub(crate) use links::{DeskEnds, Order, Report, Setting, links};
