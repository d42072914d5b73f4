//! Clock of the ticks: simulated, accelerated or real time.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Time base of the ticks: how the time of a tick relates to real time.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TimeBase {
    /// Simulated time: ticks follow each other without waiting. The logical clock starts at 0.
    Simulated,
    /// Accelerated time: ticks follow each other this many times faster than in real time. The logical clock starts at
    /// 0.
    Accelerated(u32),
    /// Real time: each tick has an absolute deadline on the monotonic clock.
    Real,
}

/// Nanoseconds before a deadline at which sleeping ends and busy-waiting begins. It exceeds the usual latency of a
/// timer.
const SPIN_NS: u64 = 60_000;
/// Lateness in nanoseconds above which the deadlines are shifted instead of caught up with, for example after a
/// suspend.
const MAX_CATCH_UP_NS: u64 = 1_000_000_000;

/// Running clock: maps ticks to deadlines in the time base of the run.
pub(crate) struct Clock {
    pace: TimeBase,
    tick_ns: u64,
    start: Instant,
    /// Nanoseconds by which all deadlines are postponed, because of skipped periods or a suspended machine.
    postponed_ns: u64,
    /// Wall clock at the start of the clock, in nanoseconds since the Unix epoch; 0 unless time is real.
    epoch_ns: i64,
}

impl Clock {
    pub(crate) fn start(pace: TimeBase, tick_ns: u64) -> Clock {
        Clock {
            pace,
            tick_ns: tick_ns.max(1),
            start: Instant::now(),
            postponed_ns: 0,
            epoch_ns: match pace {
                // No device waits for a tick here, so a long tick is no error.
                TimeBase::Simulated | TimeBase::Accelerated(_) => 0,
                TimeBase::Real => now_ns(),
            },
        }
    }

    pub(crate) fn tick_ns(&self) -> u64 {
        self.tick_ns
    }

    /// Waits until the tick with this number is due. Returns in nanoseconds how late the tick begins; 0 on simulated
    /// time.
    pub(crate) fn wait(&mut self, tick: u64) -> u64 {
        let times = match self.pace {
            TimeBase::Simulated => return 0,
            TimeBase::Real => 1,
            TimeBase::Accelerated(times) => u64::from(times.max(1)),
        };
        let due = self.tick_ns.saturating_mul(tick) / times;
        let late = self.wait_until(due.saturating_add(self.postponed_ns));
        // After a suspend or a breakpoint, thousands of overdue ticks would otherwise run back to back.
        self.postponed_ns += late.saturating_sub(MAX_CATCH_UP_NS);
        late
    }

    /// Waits until `due` nanoseconds after the start of the clock. Returns in nanoseconds how much later it is.
    fn wait_until(&self, due: u64) -> u64 {
        loop {
            let now = self.elapsed();
            match due.checked_sub(now) {
                None => return now - due,
                Some(left) if left > SPIN_NS => {
                    // A sleep ends late by the latency of the timer, so the rest is spent busy-waiting.
                    std::thread::sleep(Duration::from_nanos(left - SPIN_NS));
                }
                Some(_) => std::hint::spin_loop(),
            }
        }
    }

    /// Postpones all later ticks by this number of periods.
    pub(crate) fn postpone(&mut self, periods: u64) {
        let more = periods.saturating_mul(self.tick_ns);
        self.postponed_ns = self.postponed_ns.saturating_add(more);
    }

    /// Restarts the clock: tick 0 is due now.
    pub(crate) fn restart(&mut self) {
        *self = Clock::start(self.pace, self.tick_ns);
    }

    /// Returns the nanoseconds by which a tick that began `late` ns too late and took `took` ns ended after the next
    /// tick was due; 0 if it ended in time or unless time is real.
    pub(crate) fn overrun(&self, late: u64, took: u64) -> u64 {
        match self.pace {
            TimeBase::Simulated | TimeBase::Accelerated(_) => 0,
            TimeBase::Real => late.saturating_add(took).saturating_sub(self.tick_ns),
        }
    }

    /// Returns the wall clock for the commands in the tick with this number, in nanoseconds since the Unix epoch; on
    /// simulated and accelerated time, the logical time since the start.
    pub(crate) fn wall_ns(&self, tick: u64) -> i64 {
        let since = match self.pace {
            TimeBase::Simulated | TimeBase::Accelerated(_) => self.tick_ns.saturating_mul(tick),
            TimeBase::Real => self.elapsed(),
        };
        self.epoch_ns.saturating_add_unsigned(since)
    }

    fn elapsed(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }
}

fn now_ns() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |d| i64::try_from(d.as_nanos()).unwrap_or(i64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simulated_time_is_exact_and_never_late() {
        let mut clock = Clock::start(TimeBase::Simulated, 1_000_000);
        assert_eq!(clock.wait(1_000_000), 0);
        assert_eq!(clock.wall_ns(5), 5_000_000);
    }

    #[test]
    fn real_time_does_not_run_ahead_of_its_deadlines() {
        for (pace, tick_ns) in [
            (TimeBase::Real, 2_000_000),
            (TimeBase::Accelerated(2), 4_000_000),
        ] {
            let mut clock = Clock::start(pace, tick_ns);
            clock.wait(5);
            assert!(clock.start.elapsed() >= Duration::from_millis(10));
        }
    }

    #[test]
    fn what_is_put_off_is_due_later() {
        let mut clock = Clock::start(TimeBase::Real, 2_000_000);
        clock.postpone(5);
        clock.wait(0);
        assert!(clock.start.elapsed() >= Duration::from_millis(10));
    }
}
