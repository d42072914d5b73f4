//! Checks of runs: replay of nets against traces, tests of programs, monitoring of claims, and plots.
//!
//! It compares and reports what nets and commands compute. It takes nets and images and must not depend on source
//! texts.

pub mod claims;
pub mod faults;
pub mod motion;
pub mod node;
pub mod plot;
pub mod replay;
pub mod testing;
