//! Measuring how late a thread is woken.

use std::io;
use std::time::{Duration, Instant};

use hdrhistogram::Histogram;
use serde::Serialize;

use crate::realtime::{self, Grant, Spread, Wanted};

/// Longest time that is told apart, nanoseconds.
const LONGEST: u64 = 10_000_000_000;

/// How late a thread was woken.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Wakes {
    /// The period at which it was to be woken, nanoseconds.
    pub period_ns: u64,
    /// How often it was.
    pub count: u64,
    /// How late, nanoseconds.
    pub late: Spread,
    /// How often it was so late.
    pub buckets: Vec<Bucket>,
    /// What the system has said to what was asked of it.
    pub grants: Vec<String>,
    /// Whether all of it was granted.
    pub all_granted: bool,
}

/// So many were less late than this, and not less than the bucket before says.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
pub struct Bucket {
    /// Nanoseconds; none for the last bucket.
    pub below_ns: Option<u64>,
    /// How many.
    pub count: u64,
}

/// The bounds of buckets, microseconds: they tell apart what matters from 0.1 to 10 kHz.
const BOUNDS_US: [u64; 12] = [2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000];

/// Lets a thread of its own be woken so often, with what can be had of the system.
///
/// # Errors
/// If the system gives no thread.
pub fn measure(wanted: Wanted, period_ns: u64, count: u64) -> io::Result<Wakes> {
    let thread = std::thread::Builder::new().name("rpi-latency".into());
    let thread = thread.spawn(move || wake(wanted, period_ns, count))?;
    let (grants, late) = thread
        .join()
        .map_err(|_| io::Error::other("the measuring thread has failed"))?;
    Ok(Wakes {
        period_ns,
        count: late.len(),
        late: Spread::of(&late),
        buckets: buckets(&late),
        all_granted: grants.iter().all(|grant| grant.refused.is_none()),
        grants: grants.iter().map(ToString::to_string).collect(),
    })
}

fn wake(wanted: Wanted, period_ns: u64, count: u64) -> (Vec<Grant>, Histogram<u64>) {
    // Two figures are exact to 1 %; these bounds are valid.
    let mut late = Histogram::new_with_bounds(1, LONGEST, 2).expect("valid bounds");
    let grants = realtime::ask(wanted);
    let start = Instant::now();
    for k in 1..=count {
        let due = Duration::from_nanos(period_ns.saturating_mul(k));
        std::thread::sleep(due.saturating_sub(start.elapsed()));
        let over = start.elapsed().saturating_sub(due);
        late.saturating_record(u64::try_from(over.as_nanos()).unwrap_or(u64::MAX).max(1));
    }
    (grants, late)
}

/// Every wake counts for the first bound that it lies below.
fn buckets(late: &Histogram<u64>) -> Vec<Bucket> {
    let bounds = BOUNDS_US.iter().map(|us| Some(us * 1000)).chain([None]);
    let mut buckets: Vec<Bucket> = bounds
        .map(|below_ns| Bucket { below_ns, count: 0 })
        .collect();
    for step in late.iter_recorded() {
        let value = step.value_iterated_to();
        let is_below = |bucket: &&mut Bucket| bucket.below_ns.is_none_or(|below| value < below);
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
        let wakes = measure(Wanted::default(), 200_000, 50).unwrap();
        assert_eq!(wakes.count, 50);
        assert_eq!(wakes.buckets.iter().map(|b| b.count).sum::<u64>(), 50);
        assert!(wakes.late.p50 <= wakes.late.max);
    }
}
