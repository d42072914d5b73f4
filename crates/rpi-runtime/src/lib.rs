//! Execution of commands on a clock: simulated and real time, the control of a running core, the tick log of a run.
//!
//! Code here runs beside the real-time cycle, so it may allocate and format. It takes images and must not depend on nets
//! or the compiler. A run hands its tick log to a recorder by the trait [`run::StartRecording`], whose implementation is in
//! another crate.

pub mod control;
pub mod cycle_time;
pub mod latency;
mod load_error;
pub mod realtime;
pub mod run;
pub mod tick_log;

pub use load_error::ImageLoadError;
