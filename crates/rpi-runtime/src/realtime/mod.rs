//! Tick clock, real-time resources of the tick thread, and overrun handling.
//!
//! This module must not depend on what the cycle computes.

mod clock;
mod command_timer;
mod cycle_metrics;
mod overrun;
mod resources;
mod syscall_filter;
mod tick_timer;
mod timing_stats;

pub use clock::TimeBase;
pub(crate) use command_timer::CommandTimer;
pub use cycle_metrics::{BUCKET_BOUNDS_NS, CycleMetrics, DurationHistogram};
pub use overrun::{OverrunPolicy, OverrunStats, ParseOverrunPolicyError};
pub use resources::{ResourceGrant, SchedulingOptions, request_resources, use_lowest_priority};
pub use rpi_core::{CommandOverrunPolicy, OverrunThreshold};
pub use syscall_filter::{install_syscall_filter, is_syscall_filter_installed, sleep_forever};
pub use tick_timer::TickTimer;
pub use timing_stats::{Percentiles, TimingStats};

/// Options of real-time execution: scheduling priority, processor, and policies for late ticks.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct RealTime {
    /// Priority and processor core requested for the tick thread.
    pub resources: SchedulingOptions,
    /// Policy for overruns: ticks that end after the next one was due.
    pub overrun: OverrunPolicy,
    /// Overrun policy of commands that were loaded without one. An overrun is attributed to the command that took the
    /// longest in the tick.
    pub command_overrun: CommandOverrunPolicy,
    /// Whether the tick thread may only use the system calls of the clock; see [`install_syscall_filter`].
    pub syscall_filter: bool,
}

/// Requests the given real-time resources for the calling thread and installs the system call filter if it is enabled.
/// Returns for each resource whether the operating system granted it.
///
/// A thread with the filter must call [`sleep_forever()`] in the end.
#[must_use]
pub fn acquire_resources(real_time: RealTime) -> Vec<ResourceGrant> {
    let mut grants = request_resources(real_time.resources);
    grants.extend(real_time.syscall_filter.then(install_syscall_filter));
    grants
}
