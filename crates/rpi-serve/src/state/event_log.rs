//! Event log for operators: the latest lines.

use std::collections::VecDeque;
use std::fmt;
use std::time::Instant;

/// Maximum number of lines that the log keeps.
const MAX_LINES: usize = 1000;
/// Maximum number of characters per line: names given by clients may be long.
const MAX_LINE_CHARS: usize = 300;

/// The latest log lines, each with the seconds since the start of the server.
pub(crate) struct EventLog {
    begin: Instant,
    lines: VecDeque<String>,
    /// Warnings for the operator that were not taken yet.
    warnings: Vec<String>,
}

/// Maximum number of pending warnings.
const MAX_WARNINGS: usize = 100;

impl EventLog {
    /// Creates an empty log. Times count from now.
    pub(super) fn new() -> EventLog {
        EventLog {
            begin: Instant::now(),
            lines: VecDeque::new(),
            warnings: Vec::new(),
        }
    }

    /// Writes a line.
    pub(crate) fn write(&mut self, what: fmt::Arguments<'_>) {
        let seconds = self.begin.elapsed().as_secs_f64();
        let line = format!("{seconds:12.3} {what}");
        let plain = line.chars().take(MAX_LINE_CHARS);
        let plain = plain.map(|c| if c.is_control() { ' ' } else { c });
        self.lines.push_back(plain.collect());
        if self.lines.len() > MAX_LINES {
            self.lines.pop_front();
        }
    }

    /// Writes a line and keeps it as a pending warning.
    pub(crate) fn warn(&mut self, what: &str) {
        self.write(format_args!("{what}"));
        if self.warnings.len() < MAX_WARNINGS {
            self.warnings.push(what.to_owned());
        }
    }

    /// Takes the pending warnings.
    pub(crate) fn take_warnings(&mut self) -> Vec<String> {
        std::mem::take(&mut self.warnings)
    }

    /// Returns all lines, oldest first.
    pub(crate) fn text(&self) -> String {
        self.lines
            .iter()
            .flat_map(|line| [line.as_str(), "\n"])
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_keeps_the_latest_lines_and_each_in_a_line() {
        let mut log = EventLog::new();
        for number in 0..MAX_LINES + 5 {
            log.write(format_args!("line {number}\nforged"));
        }
        let text = log.text();
        assert_eq!(text.lines().count(), MAX_LINES);
        assert!(text.lines().next().unwrap().ends_with("line 5 forged"));
        log.write(format_args!("{}", "x".repeat(10_000)));
        assert!(
            log.text()
                .lines()
                .all(|l| l.chars().count() <= MAX_LINE_CHARS)
        );
    }
}
