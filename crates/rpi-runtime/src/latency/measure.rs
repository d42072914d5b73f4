//! Measurement of wake-up latency.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use hdrhistogram::Histogram;
use serde::Serialize;

use crate::realtime::{
    self, OverrunPolicy, Percentiles, ResourceGrant, SchedulingOptions, TickTimer, TimeBase,
};
use crate::run::SERVE_PERIOD;

/// Measured wake-up latency of a periodic thread: the delay from the requested to the actual wake-up.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct WakeupLatency {
    /// Period of the wake-ups in nanoseconds.
    pub period_ns: u64,
    /// Number of measured wake-ups.
    pub count: u64,
    /// Percentiles of the latency of the wake-ups, in nanoseconds.
    pub late: Percentiles,
    /// Histogram of the latency: number of wake-ups for each range of latencies, in ascending order.
    pub buckets: Vec<HistogramBucket>,
    /// For each requested real-time resource, such as a priority, a text that says whether it was granted.
    pub grants: Vec<String>,
    /// Whether the operating system granted all requested real-time resources.
    pub all_granted: bool,
}

/// Bucket of a histogram of latencies. It counts the wake-ups below its bound and not below the bound of the previous
/// bucket.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
pub struct HistogramBucket {
    /// Upper bound of the latencies in this bucket, in nanoseconds; `None` for the last bucket, which has no bound.
    pub below_ns: Option<u64>,
    /// Number of wake-ups with a latency in this bucket.
    pub count: u64,
}

/// Upper bounds of the histogram's buckets in microseconds, chosen for wake-up periods from 0.1 to 10 ms.
const BOUNDS_US: [u64; 12] = [2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000];

/// Options of a measurement of the wake-up latency.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct MeasuringOptions {
    /// Real-time resources to request for the measuring thread: priority and processor core.
    pub resources: SchedulingOptions,
    /// Period of the wake-ups in nanoseconds.
    pub period_ns: u64,
    /// Number of wake-ups to measure.
    pub count: u64,
    /// Number of threads that load the processor and the memory during the measurement. They have no real-time
    /// priority.
    pub busy_threads: usize,
}

/// Measures the wake-up latency of a new thread with the requested resources. The thread waits as the cycle of a run
/// does, and the calling thread is woken meanwhile as the host of a run is.
///
/// # Errors
/// Returns an error if no thread can be created.
pub fn measure(options: MeasuringOptions) -> io::Result<WakeupLatency> {
    let over = Arc::new(AtomicBool::new(false));
    let load: io::Result<Vec<_>> = (0..options.busy_threads)
        .map(|_| keep_busy(&over))
        .collect();
    let measured = measure_on_a_thread(options);
    over.store(true, Ordering::Relaxed);
    load?.into_iter().for_each(|thread| drop(thread.join()));
    let (grants, late) = measured?;
    Ok(WakeupLatency {
        period_ns: options.period_ns,
        count: late.len(),
        late: Percentiles::from_histogram(&late),
        buckets: buckets(&late),
        all_granted: grants.iter().all(|grant| grant.refusal.is_none()),
        grants: grants.iter().map(ToString::to_string).collect(),
    })
}

/// Result of a measurement: the resources requested for the measuring thread, with the operating system's answers, and
/// a histogram of the lateness of its wake-ups in nanoseconds.
type Measured = (Vec<ResourceGrant>, Histogram<u64>);

fn measure_on_a_thread(options: MeasuringOptions) -> io::Result<Measured> {
    let thread = std::thread::Builder::new().name("rpi-latency".into());
    let thread = thread.spawn(move || measure_ticks(options))?;
    while !thread.is_finished() {
        std::thread::sleep(SERVE_PERIOD);
    }
    let measured = thread.join();
    measured.map_err(|_| io::Error::other("the measuring thread panicked"))
}

fn measure_ticks(options: MeasuringOptions) -> Measured {
    let mut timer = TickTimer::start(TimeBase::Real, options.period_ns, OverrunPolicy::default());
    let grants = realtime::request_resources(options.resources);
    timer.restart();
    for tick in 1..=options.count {
        timer.wait(tick);
        // An overrun is a late wake-up here, which the histogram shows.
        let _ = timer.finish_tick(tick);
    }
    (grants, timer.into_lateness())
}

/// Starts a thread that loads the processor and the memory until `over` is set.
fn keep_busy(over: &Arc<AtomicBool>) -> io::Result<JoinHandle<()>> {
    /// Number of bytes that the thread writes repeatedly: more than the caches of a core.
    const MEMORY: usize = 16 << 20;
    let over = Arc::clone(over);
    let thread = std::thread::Builder::new().name("rpi-load".into());
    thread.spawn(move || {
        let mut memory = vec![0_u8; MEMORY];
        while !over.load(Ordering::Relaxed) {
            memory
                .iter_mut()
                .step_by(64)
                .for_each(|byte| *byte = byte.wrapping_add(1));
            std::hint::black_box(&mut memory);
        }
    })
}

/// Converts a histogram of latencies in nanoseconds to buckets: each wake-up counts in the first bucket whose bound
/// exceeds its latency.
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
        let wakes = measure(MeasuringOptions {
            resources: SchedulingOptions::default(),
            period_ns: 200_000,
            count: 50,
            busy_threads: 1,
        });
        let wakes = wakes.unwrap();
        assert_eq!(wakes.count, 50);
        assert_eq!(wakes.buckets.iter().map(|b| b.count).sum::<u64>(), 50);
        assert!(wakes.late.p50 <= wakes.late.max);
    }
}
