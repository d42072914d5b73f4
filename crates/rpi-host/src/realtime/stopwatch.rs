//! Which command of a tick takes the longest to compute.

use std::time::Instant;

use rpi_core::CommandId;

/// Told whenever another command begins to be computed; nothing in it allocates, and it calls nothing but the clock.
#[derive(Debug, Default)]
pub(crate) struct Stopwatch {
    /// Nobody wants to know: the clock is not asked.
    stands_still: bool,
    /// Who is computed, and since when.
    running: Option<(CommandId, Instant)>,
    longest: Option<(CommandId, u64)>,
}

impl Stopwatch {
    /// One that goes, or one that stands still.
    pub(crate) fn new(goes: bool) -> Stopwatch {
        Stopwatch {
            stands_still: !goes,
            ..Stopwatch::default()
        }
    }

    /// A tick begins.
    pub(crate) fn reset(&mut self) {
        (self.running, self.longest) = (None, None);
    }

    /// This command is computed from now on, or none.
    pub(crate) fn turn(&mut self, next: Option<CommandId>) {
        if self.stands_still {
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

    /// Who has taken the longest in this tick, and how many nanoseconds.
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
        let mut stopwatch = Stopwatch::new(true);
        for (id, ms) in [(short, 1), (long, 20), (short, 1)] {
            stopwatch.turn(Some(id));
            std::thread::sleep(Duration::from_millis(ms));
        }
        stopwatch.turn(None);
        let (id, took) = stopwatch.longest().unwrap();
        assert!(id == long && took >= 20_000_000, "{took}");
        stopwatch.reset();
        assert_eq!(stopwatch.longest(), None);
    }

    #[test]
    fn one_that_stands_still_asks_no_clock() {
        let mut stopwatch = Stopwatch::new(false);
        stopwatch.turn(Some(CommandId::from_number(1)));
        stopwatch.turn(None);
        assert_eq!(stopwatch.longest(), None);
    }
}
