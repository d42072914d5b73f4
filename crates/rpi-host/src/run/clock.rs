//! The clock that ticks follow: simulated, as fast as the machine allows, or real.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// What the ticks follow.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Pace {
    /// Nothing: tick after tick, with a logical clock that starts at 0.
    Simulated,
    /// Absolute deadlines on the monotonic clock.
    Real,
}

/// Nanoseconds before a deadline from which on the clock is asked again and again instead of sleeping: longer than a
/// usual timer is late.
const SPIN_NS: u64 = 60_000;

/// A clock under way.
pub(super) struct Clock {
    pace: Pace,
    tick_ns: u64,
    start: Instant,
    /// Ticks by which all are put off.
    put_off: u64,
    /// Nanoseconds since the Unix epoch at the start; 0 on simulated time.
    epoch_ns: i64,
}

impl Clock {
    pub(super) fn start(pace: Pace, tick_ns: u64) -> Clock {
        Clock {
            pace,
            tick_ns,
            start: Instant::now(),
            put_off: 0,
            epoch_ns: match pace {
                Pace::Simulated => 0,
                Pace::Real => now_ns(),
            },
        }
    }

    /// Waits until a tick is due; how late it is then, in nanoseconds. Never late on simulated time.
    pub(super) fn wait(&self, tick: u64) -> u64 {
        if self.pace == Pace::Simulated {
            return 0;
        }
        let due = self
            .tick_ns
            .saturating_mul(tick.saturating_add(self.put_off));
        loop {
            let now = self.elapsed();
            match due.checked_sub(now) {
                None => return now - due,
                Some(left) if left > SPIN_NS => {
                    std::thread::sleep(Duration::from_nanos(left - SPIN_NS));
                }
                Some(_) => std::hint::spin_loop(),
            }
        }
    }

    /// Puts all later ticks off by so many periods.
    pub(super) fn put_off(&mut self, periods: u64) {
        self.put_off = self.put_off.saturating_add(periods);
    }

    /// Begins anew: tick 0 is due now.
    pub(super) fn restart(&mut self) {
        *self = Clock::start(self.pace, self.tick_ns);
    }

    /// How much later than the next tick is due it is after one that began so late and took so long, nanoseconds. Never on simulated time.
    pub(super) fn overrun(&self, late: u64, took: u64) -> u64 {
        match self.pace {
            Pace::Simulated => 0,
            Pace::Real => late.saturating_add(took).saturating_sub(self.tick_ns),
        }
    }

    /// The wall clock that the commands of a tick see, nanoseconds since the Unix epoch.
    pub(super) fn wall_ns(&self, tick: u64) -> i64 {
        let since = match self.pace {
            Pace::Simulated => self.tick_ns.saturating_mul(tick),
            Pace::Real => self.elapsed(),
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
        let clock = Clock::start(Pace::Simulated, 1_000_000);
        assert_eq!(clock.wait(1_000_000), 0);
        assert_eq!(clock.wall_ns(5), 5_000_000);
    }

    #[test]
    fn real_time_does_not_run_ahead_of_its_deadlines() {
        let clock = Clock::start(Pace::Real, 2_000_000);
        clock.wait(5);
        assert!(clock.start.elapsed() >= Duration::from_millis(10));
    }
}
