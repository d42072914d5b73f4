//! Checks of runs: replay of nets against traces, tests of programs, monitoring of claims, plots, and graphs of nets.
//!
//! It compares and reports what nets and commands compute. It takes nets and images and must not depend on source
//! texts.

pub mod faults;
pub mod monitor;
pub mod motion;
mod net_graph;
pub mod node_runner;
pub mod plot;
pub mod testing;
pub mod trace_compare;
pub mod why;

pub use net_graph::net_graph;
