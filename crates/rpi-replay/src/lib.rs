//! Checks of runs: replay of nets against traces, tests of programs, monitoring of claims, and plots.
//!
//! It compares and reports what nets and commands compute. It takes nets and images and must not depend on source
//! texts.

pub mod faults;
pub mod monitor;
pub mod motion;
pub mod node_runner;
pub mod plot;
pub mod testing;
pub mod trace_compare;
pub mod why;
