//! Statistics of the duration and lateness of ticks.

use std::sync::Arc;

use hdrhistogram::Histogram;
use serde::Serialize;

use super::cycle_metrics::CycleMetrics;
use super::overrun::OverrunStats;

/// Largest duration that the histograms distinguish, in nanoseconds; larger ones count as this value.
const LONGEST: u64 = 60_000_000_000;

/// Timing statistics of a run: durations and delays of its ticks.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize)]
pub struct TimingStats {
    /// Number of ticks in the run.
    pub ticks: u64,
    /// Percentiles of the durations of the ticks, in nanoseconds.
    pub tick: Percentiles,
    /// Percentiles of the delays from the due time to the start of each tick, in nanoseconds; `None` unless time is
    /// real.
    pub lateness: Option<Percentiles>,
    /// Statistics of overruns (ticks that ended after the next one was due); `None` unless time is real.
    pub overruns: Option<OverrunStats>,
}

/// Median, 99th percentile and maximum of durations in nanoseconds, accurate to 1 %.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize)]
pub struct Percentiles {
    /// Duration that half of the measured durations do not exceed (median), in nanoseconds.
    pub p50: u64,
    /// Duration that 99 % of the measured durations do not exceed, in nanoseconds.
    pub p99: u64,
    /// Longest of the measured durations, in nanoseconds.
    pub max: u64,
}

fn histogram() -> Histogram<u64> {
    // Two significant digits give an accuracy of 1 %. These bounds are always valid.
    Histogram::new_with_bounds(1, LONGEST, 2).expect("valid bounds")
}

/// Histograms of the durations of the ticks of a run and of the delays of their starts. Recording a value neither
/// allocates nor fails.
pub(crate) struct TimingHistograms {
    tick: Histogram<u64>,
    lateness: Option<Histogram<u64>>,
    pub(crate) overruns: OverrunStats,
    /// Counters that other threads may read during the run.
    pub(crate) metrics: Arc<CycleMetrics>,
}

impl TimingHistograms {
    /// Creates empty histograms. `lateness` enables the histogram of the delays from the due time to the start of each
    /// tick.
    pub(crate) fn new(lateness: bool) -> TimingHistograms {
        TimingHistograms {
            tick: histogram(),
            lateness: lateness.then(histogram),
            overruns: OverrunStats::default(),
            metrics: Arc::default(),
        }
    }

    pub(crate) fn record(&mut self, tick_ns: u64, late_ns: u64) {
        // 1 ns is the lowest value that the histograms distinguish.
        self.tick.saturating_record(tick_ns.max(1));
        let late_ns = self.lateness.as_mut().map(|lateness| {
            lateness.saturating_record(late_ns.max(1));
            late_ns
        });
        self.metrics.record_tick(tick_ns, late_ns);
    }

    /// Returns the histogram of the delays from the due time to the start of each tick, in nanoseconds; empty if it was
    /// not enabled.
    pub(crate) fn into_lateness(self) -> Histogram<u64> {
        self.lateness.unwrap_or_else(histogram)
    }

    pub(crate) fn stats(&self) -> TimingStats {
        TimingStats {
            ticks: self.tick.len(),
            tick: Percentiles::from_histogram(&self.tick),
            lateness: self.lateness.as_ref().map(Percentiles::from_histogram),
            overruns: self.lateness.as_ref().map(|_| self.overruns),
        }
    }
}

impl Percentiles {
    /// Returns median, 99th percentile and maximum of the values in a histogram, in its unit.
    pub(crate) fn from_histogram(histogram: &Histogram<u64>) -> Percentiles {
        Percentiles {
            p50: histogram.value_at_quantile(0.5),
            p99: histogram.value_at_quantile(0.99),
            max: histogram.max(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_exact_to_a_percent() {
        let mut meter = TimingHistograms::new(false);
        (1..=1000).for_each(|k| meter.record(k * 1000, 0));
        let figures = meter.stats();
        let near = |a: u64, b: u64| a.abs_diff(b) * 100 <= b;
        assert!(near(figures.tick.p50, 500_000) && near(figures.tick.p99, 990_000));
        assert!(near(figures.tick.max, 1_000_000));
        assert_eq!((figures.ticks, figures.lateness), (1000, None));
    }

    #[test]
    fn absurd_times_are_cut_not_lost() {
        let mut meter = TimingHistograms::new(true);
        meter.record(u64::MAX, 0);
        assert_eq!(meter.stats().ticks, 1);
    }
}
