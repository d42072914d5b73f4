//! Measures which command takes the longest in a tick.

use std::time::Instant;

use rpi_core::CommandId;

/// Stopwatch that measures the time of each command in a tick and stores the longest one. No method allocates; the only
/// system call is that of the clock.
#[derive(Debug, Default)]
pub(crate) struct CommandTimer {
    /// Whether measurement is disabled. The clock is then never read.
    is_disabled: bool,
    /// Id of the command that is being computed, and the time at which its computation started; `None` between
    /// commands.
    running: Option<(CommandId, Instant)>,
    longest: Option<(CommandId, u64)>,
}

impl CommandTimer {
    /// Creates a stopwatch. With `goes` false, the stopwatch never measures.
    pub(crate) fn new(goes: bool) -> CommandTimer {
        CommandTimer {
            is_disabled: !goes,
            ..CommandTimer::default()
        }
    }

    /// Discards the measurements of the previous tick, at the start of a new one.
    pub(crate) fn reset(&mut self) {
        (self.running, self.longest) = (None, None);
    }

    /// Ends the measurement of the current command and starts that of the command `next`, if there is one.
    pub(crate) fn switch_to(&mut self, next: Option<CommandId>) {
        if self.is_disabled {
            return;
        }
        let now = Instant::now();
        if let Some((id, since)) = self.running {
            let took = u64::try_from((now - since).as_nanos()).unwrap_or(u64::MAX);
            if self.longest.is_none_or(|(_, longest)| took > longest) {
                self.longest = Some((id, took));
            }
        }
        self.running = next.map(|id| (id, now));
    }

    /// Returns the id of the command that took the longest in this tick, with its time in nanoseconds; `None` if
    /// nothing was measured.
    pub(crate) fn longest(&self) -> Option<(CommandId, u64)> {
        self.longest
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn the_longest_is_told_and_how_long_it_was() {
        let [short, long] = [1, 2].map(CommandId::from_number);
        let mut stopwatch = CommandTimer::new(true);
        for (id, ms) in [(short, 1), (long, 20), (short, 1)] {
            stopwatch.switch_to(Some(id));
            std::thread::sleep(Duration::from_millis(ms));
        }
        stopwatch.switch_to(None);
        let (id, took) = stopwatch.longest().unwrap();
        assert!(id == long && took >= 20_000_000, "{took}");
        stopwatch.reset();
        assert_eq!(stopwatch.longest(), None);
    }

    #[test]
    fn one_that_stands_still_asks_no_clock() {
        let mut stopwatch = CommandTimer::new(false);
        stopwatch.switch_to(Some(CommandId::from_number(1)));
        stopwatch.switch_to(None);
        assert_eq!(stopwatch.longest(), None);
    }
}
