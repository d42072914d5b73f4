//! Statistics at the end of a run: time of the task and of its rounds, takeovers in motion, limits.

use std::fmt;

use rpi_words::with_noun;

use super::outcome::{CommandEnd, Outcome, RunEnd};
use super::usage::{Margins, time_at_limits};

/// Time of a task, and of its rounds if it repeats.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TaskTime {
    /// Time from the first cycle of the first command to the last cycle of the last one, s.
    pub total: f64,
    /// Rounds of the task; `None` if the listed commands do not repeat.
    pub rounds: Option<Rounds>,
}

/// Complete rounds of a task that repeats the same commands.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Rounds {
    /// Number of complete rounds among the listed commands, at least 2.
    pub count: usize,
    /// Time of the shortest round, s.
    pub shortest: f64,
    /// Time of the longest round, s.
    pub longest: f64,
}

impl Outcome {
    /// Returns the time of the task of the run, with its rounds; `None` if no command has started.
    #[must_use]
    pub fn task_time(&self) -> Option<TaskTime> {
        let seconds = |ticks: u64| ticks as f64 * self.tick_ns as f64 * 1e-9;
        let started: Vec<(&CommandEnd, u64)> = self
            .commands
            .iter()
            .filter_map(|command| Some((command, command.first_tick?)))
            .collect();
        let ends = started
            .iter()
            .map(|(command, first)| first + command.cycles);
        let end = ends.max()?;
        // A run that lists its latest commands only began with the first tick.
        let first = started.first().filter(|_| self.unlisted == 0);
        Some(TaskTime {
            total: seconds(end - first.map_or(0, |(_, first)| *first)),
            rounds: rounds(&started).map(|ticks| Rounds {
                count: ticks.len(),
                shortest: seconds(ticks.iter().copied().min().unwrap_or(0)),
                longest: seconds(ticks.iter().copied().max().unwrap_or(0)),
            }),
        })
    }

    /// Prints the time of the task, the share of takeovers in motion, the time at limits and the smallest margins.
    pub(super) fn statistics(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(time) = self.task_time() else {
            return Ok(());
        };
        writeln!(f, "task time   {time}")?;
        let possible = self.blended + self.missed;
        if possible > 0 {
            let percent = 100.0 * self.blended as f64 / possible as f64;
            let corners = with_noun(possible, "takeover");
            writeln!(
                f,
                "blended     {} of {corners} in motion ({percent:.0} %)",
                self.blended
            )?;
        }
        for device in self.devices.iter().filter(|device| !device.axes.is_empty()) {
            let (name, axes) = (&device.name, &device.axes);
            writeln!(
                f,
                "at limits   {name}: {}",
                time_at_limits(axes, time.total)
            )?;
            writeln!(f, "margins     {name}: {}", Margins(axes))?;
        }
        Ok(())
    }
}

impl fmt::Display for TaskTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.3} s", self.total)?;
        let Some(Rounds {
            count,
            shortest,
            longest,
        }) = self.rounds
        else {
            return Ok(());
        };
        match longest - shortest {
            difference if difference < 1e-9 => write!(f, "; {count} rounds of {shortest:.3} s"),
            _ => write!(f, "; {count} rounds of {shortest:.3} s to {longest:.3} s"),
        }
    }
}

/// Returns the lengths of the complete rounds of a task in ticks; `None` if the commands do not repeat. `started` are the
/// commands in the order of their starts, with their first ticks.
///
/// The structure of the task is not known here: a recording or a list of commands without an end has none. A round is the shortest
/// sequence of commands that the list consists of, apart from fewer commands than a round before the first one. So two
/// equal commands at the end of a task do not count as rounds.
fn rounds(started: &[(&CommandEnd, u64)]) -> Option<Vec<u64>> {
    let count = started.len();
    let same = |a: usize, b: usize| started[a].0.name == started[b].0.name;
    let repeats = |length: &usize| {
        let before = (0..count - length).rev().find(|k| !same(*k, k + length));
        let first = before.map_or(0, |before| before + 1);
        (first < *length && count - first >= 2 * length).then_some((first, *length))
    };
    let (first, length) = (1..=count / 2).find_map(|length| repeats(&length))?;
    let mut starts: Vec<u64> = started[first..]
        .iter()
        .step_by(length)
        .map(|s| s.1)
        .collect();
    let (last, last_start) = started.last()?;
    // The last round is complete if its last command has ended by itself.
    if (count - first).is_multiple_of(length) && last.end != RunEnd::CutOff {
        starts.push(last_start + last.cycles);
    }
    let lengths = starts.windows(2).map(|pair| pair[1] - pair[0]).collect();
    (starts.len() > 2).then_some(lengths)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Commands with these names, each of 10 cycles and a gap of `gap` ticks before each.
    fn commands(names: &str, cut_off: bool) -> Vec<CommandEnd> {
        let count = names.len();
        let each = names.chars().enumerate();
        each.map(|(k, name)| CommandEnd {
            name: name.to_string(),
            first_tick: Some(10 * k as u64),
            cycles: 10,
            end: match cut_off && k + 1 == count {
                true => RunEnd::CutOff,
                false => RunEnd::Terminated,
            },
            braked: Vec::new(),
            handled: false,
            jump: None,
            overruns: None,
        })
        .collect()
    }

    fn lengths(names: &str, cut_off: bool) -> Option<Vec<u64>> {
        let commands = commands(names, cut_off);
        let started: Vec<_> = commands
            .iter()
            .map(|c| (c, c.first_tick.unwrap()))
            .collect();
        rounds(&started)
    }

    #[test]
    fn a_repeated_sequence_has_rounds() {
        assert_eq!(lengths("abcabc", false), Some(vec![30, 30]));
        assert_eq!(lengths("aaa", false), Some(vec![10, 10, 10]));
        assert_eq!(lengths("aabaab", false), Some(vec![30, 30]));
        assert_eq!(lengths("xabcabcab", false), Some(vec![30, 30]));
    }

    #[test]
    fn a_round_that_is_cut_off_does_not_count() {
        assert_eq!(lengths("ababab", true), Some(vec![20, 20]));
        assert_eq!(lengths("abab", true), None);
    }

    #[test]
    fn a_list_without_repetition_has_no_rounds() {
        for names in ["", "a", "abc", "abb", "abcdcd"] {
            assert_eq!(lengths(names, false), None, "{names}");
        }
    }

    #[test]
    fn the_time_of_a_task_names_its_rounds() {
        let rounds = |shortest, longest| TaskTime {
            total: 6.0,
            rounds: Some(Rounds {
                count: 3,
                shortest,
                longest,
            }),
        };
        assert_eq!(rounds(2.0, 2.0).to_string(), "6.000 s; 3 rounds of 2.000 s");
        assert_eq!(
            rounds(1.5, 2.5).to_string(),
            "6.000 s; 3 rounds of 1.500 s to 2.500 s"
        );
        let once = TaskTime {
            total: 0.25,
            rounds: None,
        };
        assert_eq!(once.to_string(), "0.250 s");
    }
}
