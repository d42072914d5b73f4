//! Shortest period that a machine can meet.

use std::fmt;

use serde::Serialize;

use super::measure::{HistogramBucket, WakeupLatency};
use crate::realtime::Percentiles;
use crate::run::time_text;

/// Timing of a program whose cycles were measured on the machine.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct CycleTiming {
    /// Name of the program.
    pub name: String,
    /// Percentiles of the duration of the cycles, in nanoseconds.
    pub cycle: Percentiles,
    /// Percentiles of the delay from the due time to the start of each cycle, in nanoseconds.
    pub late: Percentiles,
}

/// Shortest period that a machine can meet, with the measurements behind it.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct PeriodVerdict {
    /// Measured wake-up latency of an empty cycle.
    pub wakes: WakeupLatency,
    /// Timing of a measured program; `None` if only the wake-up latency was measured.
    pub load: Option<CycleTiming>,
    /// Worst-case time from the due time of a cycle to its end, in nanoseconds: the largest latency plus the longest
    /// cycle.
    pub needed_ns: u64,
    /// Shortest period of `PERIODS_NS` that is longer than `needed_ns`, in nanoseconds; `None` if there is none.
    pub holds_ns: Option<u64>,
}

/// Common periods of robot controllers in nanoseconds, in ascending order.
const PERIODS_NS: [u64; 10] = [
    100_000, 125_000, 250_000, 500_000, 1_000_000, 2_000_000, 4_000_000, 8_000_000, 12_000_000,
    25_000_000,
];

/// Computes the shortest common period that the machine can meet, from the wake-up latency and, if given, the timing of
/// a program.
#[must_use]
pub fn verdict(wakes: WakeupLatency, load: Option<CycleTiming>) -> PeriodVerdict {
    let run_late = load.as_ref().map_or(0, |load| load.late.max);
    let cycle = load.as_ref().map_or(0, |load| load.cycle.max);
    let needed_ns = wakes.late.max.max(run_late).saturating_add(cycle);
    let holds_ns = PERIODS_NS.into_iter().find(|period| *period > needed_ns);
    PeriodVerdict {
        wakes,
        load,
        needed_ns,
        holds_ns,
    }
}

impl PeriodVerdict {
    /// Returns the verdict as one indented JSON object.
    #[must_use]
    pub fn to_json(&self) -> String {
        // Serialising strings, numbers and lists cannot fail.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    fn reason(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let late = self.load.as_ref().map_or(0, |load| load.late.max);
        let late = time_text(self.wakes.late.max.max(late));
        match &self.load {
            None => writeln!(f, "  the worst wake-up was {late} late"),
            Some(load) => {
                let (cycle, needed) = (time_text(load.cycle.max), time_text(self.needed_ns));
                writeln!(
                    f,
                    "  the worst wake-up was {late} late, the longest cycle took {cycle}: {needed} together"
                )
            }
        }
    }
}

/// Number of characters of the longest bar when the histogram is printed as text.
const BAR_WIDTH: u64 = 50;

impl fmt::Display for PeriodVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let wakes = &self.wakes;
        let (count, period) = (wakes.count, time_text(wakes.period_ns));
        writeln!(
            f,
            "woken {}, every {period}; late by {}",
            rpi_words::times(count),
            wakes.late
        )?;
        let most = wakes.buckets.iter().map(|b| b.count).max().unwrap_or(0);
        let shown = wakes.buckets.iter().filter(|b| b.count > 0);
        shown
            .clone()
            .try_for_each(|bucket| histogram_line(f, bucket, most))?;
        if let Some(load) = &self.load {
            writeln!(
                f,
                "{}: cycle time {}; late by {}",
                load.name, load.cycle, load.late
            )?;
        }
        wakes
            .grants
            .iter()
            .try_for_each(|grant| writeln!(f, "  {grant}"))?;
        match self.holds_ns {
            Some(period) => writeln!(f, "holds a period of {}", time_text(period))?,
            None => writeln!(f, "holds no common period")?,
        }
        self.reason(f)?;
        match wakes.all_granted {
            true => writeln!(
                f,
                "  measure for hours under the usual load before you rely on this result"
            ),
            false => writeln!(
                f,
                "  some resources were not granted, so other programs may increase the latency"
            ),
        }
    }
}

fn histogram_line(f: &mut fmt::Formatter<'_>, bucket: &HistogramBucket, most: u64) -> fmt::Result {
    let below = bucket
        .below_ns
        .map_or("more".to_owned(), |ns| format!("< {}", time_text(ns)));
    let bar = (bucket.count * BAR_WIDTH).div_ceil(most.max(1));
    let bar = "#".repeat(usize::try_from(bar).unwrap_or(0));
    writeln!(f, "  {below:>9} {:>9}  {bar}", bucket.count)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wakes(max: u64, all_granted: bool) -> WakeupLatency {
        let late = Percentiles {
            p50: 1000,
            p99: 2000,
            max,
        };
        let count = 3;
        let bucket = HistogramBucket {
            below_ns: None,
            count,
        };
        WakeupLatency {
            period_ns: 1_000_000,
            count,
            late,
            buckets: vec![bucket],
            grants: Vec::new(),
            all_granted,
        }
    }

    fn load(cycle: u64, late: u64) -> Option<CycleTiming> {
        let spread = |max| Percentiles {
            p50: 1,
            p99: 1,
            max,
        };
        Some(CycleTiming {
            name: "net".into(),
            cycle: spread(cycle),
            late: spread(late),
        })
    }

    #[test]
    fn the_period_is_the_shortest_that_the_worst_cycle_leaves_room_for() {
        assert_eq!(verdict(wakes(99_000, true), None).holds_ns, Some(100_000));
        assert_eq!(verdict(wakes(100_000, true), None).holds_ns, Some(125_000));
        assert_eq!(
            verdict(wakes(99_000, true), load(200_000, 0)).holds_ns,
            Some(500_000)
        );
        assert_eq!(
            verdict(wakes(1, true), load(200_000, 900_000)).needed_ns,
            1_100_000
        );
        assert_eq!(verdict(wakes(25_000_000, true), None).holds_ns, None);
    }

    #[test]
    fn it_says_why_and_what_it_is_worth() {
        let text = verdict(wakes(99_000, false), load(200_000, 0)).to_string();
        for part in [
            "holds a period of 500 us",
            "99.0 us late",
            "299 us together",
            "not granted",
        ] {
            assert!(text.contains(part), "{part} is missing:\n{text}");
        }
    }
}
