//! Recordings: what a run's samples are written to.
//!
//! A recording has one row per flow and cycle: the number of the tick (from 0), the flow's name, its value in the text
//! form of nets ([`rpi_net::literal`]), `null` for an absent one.

mod digest;
mod filter;
mod motion;
mod rows;
mod traced;

pub use digest::Digest;
pub use filter::{Filter, copy};
pub use motion::Motion;
pub use rows::{Form, Rows};
pub use traced::Traced;
