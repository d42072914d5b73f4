//! Wake-up latency of a machine, and the shortest period that it allows.
//!
//! The method is that of `cyclictest`, with the waiting of a run: a thread with the priority, locked memory and core of a cycle
//! waits for its next deadline by the tick timer and then reads the clock. Its lateness shows the delays caused by the kernel,
//! interrupts and other programs. This module must not depend on what a cycle computes.

mod measure;
mod verdict;

pub use measure::{HistogramBucket, MeasuringOptions, WakeupLatency, measure};
pub use verdict::{CycleTiming, PeriodVerdict, verdict};
