//! The clock that ticks follow: absolute deadlines on the monotonic clock, or as fast as the machine allows.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// What the ticks follow.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Pace {
    /// Absolute deadlines on the monotonic clock.
    Real,
    /// So many times as fast as that, on a logical clock that starts at 0.
    Faster(u32),
}

/// Nanoseconds before a deadline from which on the clock is asked again and again instead of sleeping.
const SPIN_NS: u64 = 60_000;
/// Further behind than this the deadlines are moved instead of caught up with: after a suspended machine, say.
const BEHIND_NS: u64 = 1_000_000_000;

/// A clock under way.
pub(crate) struct Clock {
    pace: Pace,
    tick_ns: u64,
    start: Instant,
    /// What was given up, nanoseconds.
    moved_ns: u64,
    /// Nanoseconds since the Unix epoch at the start.
    epoch_ns: i64,
}

impl Clock {
    pub(crate) fn start(pace: Pace, tick_ns: u64) -> Clock {
        Clock {
            pace,
            tick_ns: tick_ns.max(1),
            start: Instant::now(),
            moved_ns: 0,
            epoch_ns: match pace {
                Pace::Faster(_) => 0,
                Pace::Real => now_ns(),
            },
        }
    }

    pub(crate) fn tick_ns(&self) -> u64 {
        self.tick_ns
    }

    /// Waits until a tick is due.
    pub(crate) fn wait(&mut self, tick: u64) {
        let times = match self.pace {
            Pace::Real => 1,
            Pace::Faster(times) => u64::from(times.max(1)),
        };
        let due = self.tick_ns.saturating_mul(tick) / times + self.moved_ns;
        loop {
            let now = u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX);
            match due.checked_sub(now) {
                None => {
                    self.moved_ns += (now - due).saturating_sub(BEHIND_NS);
                    return;
                }
                Some(left) if left > SPIN_NS => {
                    std::thread::sleep(Duration::from_nanos(left - SPIN_NS));
                }
                Some(_) => std::hint::spin_loop(),
            }
        }
    }

    /// The wall clock that the commands of a tick see, nanoseconds since the Unix epoch.
    pub(crate) fn wall_ns(&self, tick: u64) -> i64 {
        let since = match self.pace {
            Pace::Faster(_) => self.tick_ns.saturating_mul(tick),
            Pace::Real => u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX),
        };
        self.epoch_ns.saturating_add_unsigned(since)
    }
}

fn now_ns() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |d| i64::try_from(d.as_nanos()).unwrap_or(i64::MAX))
}
