//! Records of runs: recordings that can be replayed, samples as rows or digests, and input traces.
//!
//! It takes what the runtime observes in a run and must not depend on nets or the compiler.

pub mod mcap;
pub mod run_table;
pub mod sample_output;
pub mod trace;
