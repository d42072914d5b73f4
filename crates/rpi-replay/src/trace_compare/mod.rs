//! Trace replay: executes a net with the inputs of a recorded trace and compares every computed value with the trace.
//!
//! Values from outside the net are taken from the trace: device ports, inputs, cancel, the wall clock, the start time
//! ([`inputs`]). All other values are computed and distanced, including their absence; [`distance`] defines the
//! tolerance. A deviating value that a documented difference between the systems explains is taken from the trace,
//! counted and listed, and later values are computed from it.

mod angles;
mod bank;
mod comparison;
mod comparison_plan;
mod counters;
mod distance;
mod divergence_path;
mod engine;
mod explain;
mod inputs;
mod names;
mod options;
mod port_values;
mod print;
mod relation;
mod report;
mod text;
mod trace_view;

pub use engine::replay;
pub use options::{Options, ReplayError};
pub use report::{
    CompareReport, ComparedCounts, Divergence, DivergenceLink, ExplainedDifference,
    LargestDeviation, PortDeviations, ReplayFault,
};
