//! Output formats for the samples of a run.
//!
//! A file has one row per flow and cycle: the number of the tick (from 0), the name of the flow, and its value in the
//! text format of nets ([`rpi_literal`]); `null` for an absent value.

mod digest;
mod filter;
mod rows;
mod traced;

pub use digest::Digest;
pub use filter::{Filter, copy};
pub use rows::{Form, Rows};
pub use traced::Traced;
