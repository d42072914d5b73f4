//! Replay: a net runs against a recorded trace, and every recorded value that it computes is compared.
//!
//! What came from outside is taken from the trace: device ports, inputs, cancel, the wall clock, the start time
//! ([`inputs`]). Everything else is computed from it and compared, absence included; the tolerance is told in
//! [`compare`]. A value that a documented difference between the systems explains is taken from the trace, counted and
//! listed, and what follows is computed from it.

mod angles;
mod bank;
mod compare;
mod engine;
mod explain;
mod inputs;
mod judge;
mod look;
mod names;
mod options;
mod path;
mod plan;
mod print;
mod recorded;
mod relation;
mod report;
mod tally;
mod text;

pub use engine::replay;
pub use options::{Options, ReplayError};
pub use report::{Agreed, Divergence, Explained, Fault, Link, PortTally, Report, Worst};
