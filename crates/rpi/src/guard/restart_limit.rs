//! Limit of the restarts: a core that crashes again and again is not restarted for ever.

use std::time::{Duration, Instant};

/// Maximum number of restarts within [`RESTART_WINDOW`].
pub(super) const MAX_RESTARTS: usize = 3;
/// Time in which the restarts are counted.
pub(super) const RESTART_WINDOW: Duration = Duration::from_secs(60);

/// Times of the latest restarts.
#[derive(Debug, Default)]
pub(super) struct RestartLimit {
    times: Vec<Instant>,
}

impl RestartLimit {
    /// Counts a restart at the time `now`. Returns its number within the window, from 1; `None` if there were too many.
    pub(super) fn next(&mut self, now: Instant) -> Option<usize> {
        self.times
            .retain(|time| now.duration_since(*time) < RESTART_WINDOW);
        if self.times.len() >= MAX_RESTARTS {
            return None;
        }
        self.times.push(now);
        Some(self.times.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn restarts_are_counted_within_a_window() {
        let mut limit = RestartLimit::default();
        let begin = Instant::now();
        let counts = [0, 1, 2, 3].map(|second| limit.next(begin + Duration::from_secs(second)));
        assert_eq!(counts, [Some(1), Some(2), Some(3), None]);
        assert_eq!(limit.next(begin + RESTART_WINDOW), Some(3));
    }
}
