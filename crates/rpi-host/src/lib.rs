//! Running a command on a clock: simulated and real time, recording, replay against traces, plots.
//!
//! This crate stands on the host's side of the cycle: it may read files, allocate and format. It must not know how a
//! program is compiled; it takes nets and images.

pub mod claims;
pub mod control;
pub mod latency;
pub mod measure;
pub mod node;
pub mod plot;
pub mod realtime;
pub mod record;
pub mod recording;
pub mod replay;
pub mod run;
mod tape;
pub mod testing;
pub mod trace;
