//! Output formats for the samples of a run.
//!
//! A file has one row per flow and cycle: the number of the tick (from 0), the name of the flow, and its value in the
//! text format of nets ([`rpi_literal`]); `null` for an absent value.

mod digest;
mod filter;
mod rows;
mod trace_sink;

pub use digest::DigestSink;
pub use filter::{RowFilter, copy_matching};
pub use rows::{SampleFormat, SampleWriter};
pub use trace_sink::TraceSink;
