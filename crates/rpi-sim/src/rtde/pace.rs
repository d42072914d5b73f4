//! Number of cycles of the controller for which set-points are due: by its clock, or by that of this machine while samples are
//! late.

use std::time::{Duration, Instant};

/// Lateness of a sample, in cycles, after which the clock of this machine takes its place.
const LATENESS: f64 = 0.5;
/// Maximum difference of the clock between two samples, in s. After a longer one, such as at a restart of the controller,
/// counting begins again.
const MAX_GAP: f64 = 2.0;

/// Count of the controller's cycles.
///
/// All times are whole cycles after the last sample. So commands in place of late samples come at the same phase of the
/// controller's cycle, and a velocity stays constant for the program, which reads one command in each cycle.
pub(super) struct Pace {
    /// Duration of a cycle of the controller, in s.
    cycle: f64,
    /// Clock of the controller at the last sample, in s; `None` before the first one.
    clock: Option<f64>,
    /// Time at which the last sample came.
    arrival: Instant,
    /// Number of cycles after the last sample for which set-points were played; negative if the count is behind.
    played: i64,
}

impl Pace {
    /// Creates a count for a controller with cycles of `cycle` s.
    pub(super) fn new(cycle: f64, now: Instant) -> Self {
        Self {
            cycle,
            clock: None,
            arrival: now,
            played: 0,
        }
    }

    /// Returns the time since the last sample.
    pub(super) fn silence(&self, now: Instant) -> Duration {
        now.saturating_duration_since(self.arrival)
    }

    /// Returns the time until which the next sample may come before the clock of this machine takes its place.
    pub(super) fn deadline(&self) -> Instant {
        let cycles = self.played.max(0) as f64 + 1.0 + LATENESS;
        self.arrival + Duration::from_secs_f64(cycles * self.cycle)
    }

    /// A sample with this clock (s) has come. Returns the number of cycles that are due.
    pub(super) fn take_sample(&mut self, clock: f64, now: Instant) -> u32 {
        let passed = clock - self.clock.unwrap_or(clock);
        self.arrival = now;
        self.clock = Some(clock);
        if !(0.0..=MAX_GAP).contains(&passed) {
            self.played = 0;
            return 1;
        }
        self.played -= (passed / self.cycle).round() as i64;
        // The count is ahead if the controller's clock stood still, for example because its process was stopped.
        self.take(0)
    }

    /// No sample has come. Returns the number of cycles that are due by the clock of this machine.
    pub(super) fn take_time(&mut self, now: Instant) -> u32 {
        let cycles = self.silence(now).as_secs_f64() / self.cycle - LATENESS;
        self.take(cycles.floor() as i64)
    }

    fn take(&mut self, until: i64) -> u32 {
        let due = (until - self.played).max(0);
        self.played += due;
        u32::try_from(due).unwrap_or(u32::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CYCLE: f64 = 0.002;

    fn after(begin: Instant, cycles: f64) -> Instant {
        begin + Duration::from_secs_f64(cycles * CYCLE)
    }

    #[test]
    fn late_samples_leave_the_number_of_cycles_as_it_is() {
        let begin = Instant::now();
        let mut pace = Pace::new(CYCLE, begin);
        assert_eq!(pace.take_sample(7.0, begin), 0);
        assert_eq!(pace.take_sample(7.0 + CYCLE, after(begin, 1.0)), 1);
        // Samples 2 to 6 are late, the last of them comes alone.
        for cycle in 2..7 {
            let deadline = pace.deadline();
            assert!(deadline > after(begin, f64::from(cycle) + 0.49));
            assert_eq!(pace.take_time(deadline + Duration::from_micros(20)), 1);
        }
        assert_eq!(pace.take_sample(7.0 + 6.0 * CYCLE, after(begin, 6.9)), 0);
        assert_eq!(pace.take_sample(7.0 + 7.0 * CYCLE, after(begin, 7.0)), 1);
    }

    #[test]
    fn a_thread_that_wakes_late_gets_the_cycles_that_have_passed() {
        let begin = Instant::now();
        let mut pace = Pace::new(CYCLE, begin);
        pace.take_sample(7.0, begin);
        assert_eq!(pace.take_time(after(begin, 4.6)), 4);
        assert_eq!(pace.take_time(after(begin, 5.4)), 0);
        assert_eq!(pace.take_sample(7.0 + 9.0 * CYCLE, after(begin, 9.0)), 5);
    }

    #[test]
    fn a_clock_that_stood_still_or_starts_again_is_no_step() {
        let begin = Instant::now();
        let mut pace = Pace::new(CYCLE, begin);
        pace.take_sample(7.0, begin);
        assert_eq!(pace.take_time(after(begin, 10.6)), 10);
        // The controller was stopped itself: its clock is 9 cycles behind.
        assert_eq!(pace.take_sample(7.0 + CYCLE, after(begin, 11.0)), 0);
        for cycle in 2..11 {
            let now = after(begin, 10.0 + f64::from(cycle));
            assert_eq!(pace.take_sample(7.0 + f64::from(cycle) * CYCLE, now), 0);
        }
        assert_eq!(pace.take_sample(7.0 + 11.0 * CYCLE, after(begin, 22.0)), 1);
        assert_eq!(pace.take_sample(0.0, after(begin, 23.0)), 1);
        assert_eq!(pace.take_sample(50.0, after(begin, 24.0)), 1);
    }
}
