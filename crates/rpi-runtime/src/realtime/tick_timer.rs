//! Tick timer: waits for each tick, measures it and handles overruns.

use std::sync::Arc;
use std::time::Instant;

use hdrhistogram::Histogram;

use super::clock::{Clock, TimeBase};
use super::cycle_metrics::CycleMetrics;
use super::overrun::{OverrunAction, OverrunPolicy};
use super::timing_stats::{TimingHistograms, TimingStats};

/// Timer that waits for each tick and measures it. The caller repeats [`TickTimer::wait`], the work of the tick and
/// [`TickTimer::finish_tick`]. No method allocates.
pub struct TickTimer {
    clock: Clock,
    meter: TimingHistograms,
    policy: OverrunPolicy,
    /// Nanoseconds by which the latest tick ended after the next one was due.
    overrun_ns: u64,
    /// Nanoseconds by which the latest tick took longer than a period, regardless of when it began.
    excess_ns: u64,
    /// Nanoseconds by which the current tick began after it was due.
    late_ns: u64,
    begin: Instant,
}

impl TickTimer {
    /// Starts a timer of ticks with the period `tick_ns` in nanoseconds. Tick 0 is due now.
    #[must_use]
    pub fn start(pace: TimeBase, tick_ns: u64, policy: OverrunPolicy) -> TickTimer {
        TickTimer {
            clock: Clock::start(pace, tick_ns),
            meter: TimingHistograms::new(pace == TimeBase::Real),
            policy,
            overrun_ns: 0,
            excess_ns: 0,
            late_ns: 0,
            begin: Instant::now(),
        }
    }

    /// Restarts the timer: tick 0 is due now.
    pub fn restart(&mut self) {
        self.clock.restart();
    }

    /// Waits until the tick with this number is due. Returns the wall clock for the commands, in nanoseconds since the
    /// Unix epoch.
    pub fn wait(&mut self, tick: u64) -> i64 {
        self.late_ns = self.clock.wait(tick);
        self.begin = Instant::now();
        self.clock.wall_ns(tick)
    }

    /// Ends the measurement of the tick with this number. Returns true if the overrun policy requires that all commands
    /// are aborted.
    #[must_use]
    pub fn finish_tick(&mut self, tick: u64) -> bool {
        let took = u64::try_from(self.begin.elapsed().as_nanos()).unwrap_or(u64::MAX);
        self.meter.record(took, self.late_ns);
        let over = self.clock.overrun(self.late_ns, took);
        (self.overrun_ns, self.excess_ns) = (over, took.saturating_sub(self.clock.tick_ns()));
        let overruns = &mut self.meter.overruns;
        let action = overruns.record(tick, over, self.clock.tick_ns(), self.policy);
        let (count, skipped) = (overruns.count, overruns.skipped);
        self.meter.metrics.set_overruns(count, skipped);
        match action {
            OverrunAction::Continue => false,
            OverrunAction::Postpone(periods) => {
                self.clock.postpone(periods);
                false
            }
            OverrunAction::Stop => true,
        }
    }

    /// Returns two times about an overrun of the latest tick, or `None` if the tick ended in time.
    ///
    /// The first number is the time in nanoseconds by which the tick ended after the next one was due. The second
    /// number is the time in nanoseconds by which it took longer than a period; 0 if it only began too late.
    #[must_use]
    pub fn overrun(&self) -> Option<(u64, u64)> {
        Some((self.overrun_ns, self.excess_ns)).filter(|(over, _)| *over > 0)
    }

    /// Returns the histogram of the delays from the due time to the start of each tick, in nanoseconds; empty unless
    /// time is real.
    pub(crate) fn into_lateness(self) -> Histogram<u64> {
        self.meter.into_lateness()
    }

    /// Returns the counters that other threads may read while the timer is used.
    #[must_use]
    pub fn metrics(&self) -> &Arc<CycleMetrics> {
        &self.meter.metrics
    }

    /// Returns the statistics of the durations, delays and overruns of the ticks so far.
    #[must_use]
    pub fn figures(&self) -> TimingStats {
        self.meter.stats()
    }
}
