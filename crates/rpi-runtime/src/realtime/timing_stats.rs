//! Statistics of the duration and lateness of ticks.

use hdrhistogram::Histogram;
use serde::Serialize;

use super::overrun::OverrunStats;

/// Largest duration that the histograms distinguish, nanoseconds; larger ones count as this value.
const LONGEST: u64 = 60_000_000_000;

/// Timing statistics of a run.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize)]
pub struct TimingStats {
    /// Number of ticks.
    pub ticks: u64,
    /// Percentiles of the duration of the ticks, nanoseconds.
    pub tick: Percentiles,
    /// Percentiles of the lateness of the starts of the ticks, nanoseconds; only on real time.
    pub lateness: Option<Percentiles>,
    /// Statistics of overruns; only on real time.
    pub overruns: Option<OverrunStats>,
}

/// Median, 99th percentile and maximum of durations in nanoseconds, accurate to 1 %.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize)]
pub struct Percentiles {
    /// Median, nanoseconds.
    pub p50: u64,
    /// 99th percentile, nanoseconds.
    pub p99: u64,
    /// Maximum, nanoseconds.
    pub max: u64,
}

/// Histograms of the durations and the lateness of the ticks of a run. Recording a value neither allocates nor fails.
pub(crate) struct TimingHistograms {
    tick: Histogram<u64>,
    lateness: Option<Histogram<u64>>,
    pub(crate) overruns: OverrunStats,
}

impl TimingHistograms {
    /// Creates empty histograms. `lateness` enables the histogram of lateness.
    pub(crate) fn new(lateness: bool) -> TimingHistograms {
        // Two significant digits give an accuracy of 1 %. These bounds are always valid.
        let histogram = || Histogram::new_with_bounds(1, LONGEST, 2).expect("valid bounds");
        TimingHistograms {
            tick: histogram(),
            lateness: lateness.then(histogram),
            overruns: OverrunStats::default(),
        }
    }

    pub(crate) fn record(&mut self, tick_ns: u64, late_ns: u64) {
        // 1 ns is the lowest value that the histograms distinguish.
        self.tick.saturating_record(tick_ns.max(1));
        if let Some(lateness) = &mut self.lateness {
            lateness.saturating_record(late_ns.max(1));
        }
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
