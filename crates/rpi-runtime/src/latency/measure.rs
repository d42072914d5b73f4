//! Measurement of wake-up latency.

use std::io;
use std::time::{Duration, Instant};

use hdrhistogram::Histogram;
use serde::Serialize;

use crate::realtime::{self, Percentiles, ResourceGrant, SchedulingOptions};

/// Largest latency that the histogram distinguishes, nanoseconds; larger ones count as this value.
const LONGEST: u64 = 10_000_000_000;

/// Measured wake-up latency of a thread: the delay from the requested to the actual wake-up.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct WakeupLatency {
    /// Period of the wake-ups, nanoseconds.
    pub period_ns: u64,
    /// Number of wake-ups.
    pub count: u64,
    /// Percentiles of the latency, nanoseconds.
    pub late: Percentiles,
    /// Histogram of the latency.
    pub buckets: Vec<HistogramBucket>,
    /// Result of each request for real-time resources, such as a priority, as text.
    pub grants: Vec<String>,
    /// Whether the operating system granted all resources.
    pub all_granted: bool,
}

/// A bucket of the histogram. It counts the wake-ups below its bound and not below the bound of the previous bucket.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
pub struct HistogramBucket {
    /// Upper bound in nanoseconds; `None` for the last bucket.
    pub below_ns: Option<u64>,
    /// Number of wake-ups with a latency in this bucket.
    pub count: u64,
}

/// Upper bounds of the buckets in microseconds, chosen for periods from 0.1 to 10 ms.
const BOUNDS_US: [u64; 12] = [2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000];

/// Measures `count` wake-ups of a new thread with the requested resources.
///
/// # Errors
/// Returns an error if no thread can be created.
pub fn measure(wanted: SchedulingOptions, period_ns: u64, count: u64) -> io::Result<WakeupLatency> {
    let thread = std::thread::Builder::new().name("rpi-latency".into());
    let thread = thread.spawn(move || measure_thread(wanted, period_ns, count))?;
    let (grants, late) = thread
        .join()
        .map_err(|_| io::Error::other("the measuring thread panicked"))?;
    Ok(WakeupLatency {
        period_ns,
        count: late.len(),
        late: Percentiles::from_histogram(&late),
        buckets: buckets(&late),
        all_granted: grants.iter().all(|grant| grant.refusal.is_none()),
        grants: grants.iter().map(ToString::to_string).collect(),
    })
}

fn measure_thread(
    wanted: SchedulingOptions,
    period_ns: u64,
    count: u64,
) -> (Vec<ResourceGrant>, Histogram<u64>) {
    // Two significant digits give an accuracy of 1 %. These bounds are always valid.
    let mut late = Histogram::new_with_bounds(1, LONGEST, 2).expect("valid bounds");
    let grants = realtime::request_resources(wanted);
    let start = Instant::now();
    for k in 1..=count {
        let due = Duration::from_nanos(period_ns.saturating_mul(k));
        // Deadlines count from the start, so that one late tick does not shift the next. There is no busy-waiting: the
        // latency of the sleep is what is measured.
        std::thread::sleep(due.saturating_sub(start.elapsed()));
        let over = start.elapsed().saturating_sub(due);
        late.saturating_record(u64::try_from(over.as_nanos()).unwrap_or(u64::MAX).max(1));
    }
    (grants, late)
}

/// Counts each wake-up in the first bucket whose bound exceeds its latency.
fn buckets(late: &Histogram<u64>) -> Vec<HistogramBucket> {
    let bounds = BOUNDS_US.iter().map(|us| Some(us * 1000)).chain([None]);
    let mut buckets: Vec<HistogramBucket> = bounds
        .map(|below_ns| HistogramBucket { below_ns, count: 0 })
        .collect();
    for step in late.iter_recorded() {
        let value = step.value_iterated_to();
        let is_below =
            |bucket: &&mut HistogramBucket| bucket.below_ns.is_none_or(|below| value < below);
        if let Some(bucket) = buckets.iter_mut().find(is_below) {
            bucket.count += step.count_at_value();
        }
    }
    buckets
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_wake_is_in_one_bucket() {
        let wakes = measure(SchedulingOptions::default(), 200_000, 50).unwrap();
        assert_eq!(wakes.count, 50);
        assert_eq!(wakes.buckets.iter().map(|b| b.count).sum::<u64>(), 50);
        assert!(wakes.late.p50 <= wakes.late.max);
    }
}
