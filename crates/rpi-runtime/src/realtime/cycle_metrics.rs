//! Counters and histograms of the ticks that other threads may read while the cycle runs.

use std::sync::atomic::{AtomicU64, Ordering};

/// Upper bounds of the buckets of a [`DurationHistogram`], nanoseconds, inclusive.
///
/// Two or three per decade, from the time of an empty tick to ten periods of the usual tick of one millisecond: a
/// monitor shows at a glance whether ticks fit into their period.
pub const BUCKET_BOUNDS_NS: [u64; 14] = [
    1_000,
    2_000,
    5_000,
    10_000,
    20_000,
    50_000,
    100_000,
    200_000,
    500_000,
    1_000_000,
    2_000_000,
    5_000_000,
    10_000_000,
    100_000_000,
];

/// Counters of the ticks since the cycle started.
///
/// Only the cycle writes. It never waits, allocates or locks, so that a monitor cannot disturb it. A reader may see one
/// counter of a tick and not yet the other one.
#[derive(Debug, Default)]
pub struct CycleMetrics {
    /// Number of ticks that ended after the next one was due.
    overruns: AtomicU64,
    /// Number of periods by which later ticks were postponed because of overruns.
    skipped_periods: AtomicU64,
    /// Number of ticks that are missing from the recording.
    unrecorded_ticks: AtomicU64,
    /// Times that ticks took.
    pub duration: DurationHistogram,
    /// Times by which ticks began too late; empty on simulated time.
    pub lateness: DurationHistogram,
}

/// Histogram of durations with fixed buckets, see [`BUCKET_BOUNDS_NS`].
#[derive(Debug, Default)]
pub struct DurationHistogram {
    /// Number of durations in each bucket; the last one has all that exceed every bound.
    counts: [AtomicU64; BUCKET_BOUNDS_NS.len() + 1],
    /// Sum of the durations, nanoseconds.
    sum_ns: AtomicU64,
}

/// Adds to a counter that only one thread writes. A load and a store are cheaper than an atomic addition.
fn add(counter: &AtomicU64, amount: u64) {
    let sum = counter.load(Ordering::Relaxed).wrapping_add(amount);
    counter.store(sum, Ordering::Relaxed);
}

impl CycleMetrics {
    /// Counts a tick that took `duration_ns` nanoseconds. `lateness_ns` is the time by which it began too late, or `None`
    /// on simulated time.
    pub(super) fn record_tick(&self, duration_ns: u64, lateness_ns: Option<u64>) {
        self.duration.record(duration_ns);
        if let Some(lateness_ns) = lateness_ns {
            self.lateness.record(lateness_ns);
        }
    }

    /// Sets the number of overruns and of the periods by which later ticks were postponed, both since the start.
    pub(super) fn set_overruns(&self, overruns: u64, skipped_periods: u64) {
        self.overruns.store(overruns, Ordering::Relaxed);
        self.skipped_periods
            .store(skipped_periods, Ordering::Relaxed);
    }

    /// Sets the number of ticks that are missing from the recording so far.
    pub fn set_unrecorded_ticks(&self, ticks: u64) {
        self.unrecorded_ticks.store(ticks, Ordering::Relaxed);
    }

    /// Returns the number of ticks that have ended.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.duration.counts().iter().sum()
    }

    /// Returns the number of ticks that ended after the next one was due.
    #[must_use]
    pub fn overruns(&self) -> u64 {
        self.overruns.load(Ordering::Relaxed)
    }

    /// Returns the number of periods by which later ticks were postponed because of overruns.
    #[must_use]
    pub fn skipped_periods(&self) -> u64 {
        self.skipped_periods.load(Ordering::Relaxed)
    }

    /// Returns the number of ticks that are missing from the recording.
    #[must_use]
    pub fn unrecorded_ticks(&self) -> u64 {
        self.unrecorded_ticks.load(Ordering::Relaxed)
    }
}

impl DurationHistogram {
    fn record(&self, duration_ns: u64) {
        let bucket = BUCKET_BOUNDS_NS.partition_point(|bound| *bound < duration_ns);
        add(&self.counts[bucket], 1);
        add(&self.sum_ns, duration_ns);
    }

    /// Returns the number of durations in each bucket, in the order of [`BUCKET_BOUNDS_NS`]; the last one has all that
    /// exceed every bound.
    #[must_use]
    pub fn counts(&self) -> [u64; BUCKET_BOUNDS_NS.len() + 1] {
        self.counts
            .each_ref()
            .map(|count| count.load(Ordering::Relaxed))
    }

    /// Returns the sum of the durations in nanoseconds.
    #[must_use]
    pub fn sum_ns(&self) -> u64 {
        self.sum_ns.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_duration_at_a_bound_is_in_the_bucket_of_the_bound() {
        let metrics = CycleMetrics::default();
        for duration in [0, 1_000, 1_001, 100_000_000, 100_000_001] {
            metrics.record_tick(duration, None);
        }
        let counts = metrics.duration.counts();
        assert_eq!((counts[0], counts[1]), (2, 1));
        assert_eq!((counts[13], counts[14]), (1, 1));
        assert_eq!(metrics.duration.sum_ns(), 200_002_002);
        assert_eq!((metrics.ticks(), metrics.lateness.sum_ns()), (5, 0));
    }
}
