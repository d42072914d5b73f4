//! Host side of the control core: simulated and real-time execution, recording, trace replay, tests and plots.
//!
//! Code here runs outside the real-time cycle, so it may read files, allocate and format. It takes nets and images and
//! must not depend on the compiler.

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
