//! Event log for operators: the latest lines in memory, and all lines in a file.

use std::collections::VecDeque;
use std::fmt;
use std::io;
use std::path::Path;
use std::time::Instant;

use super::log_file::{Level, LogFile};

/// Maximum number of lines that the log keeps.
const MAX_LINES: usize = 1000;
/// Maximum number of characters of a message: names given by clients may be long.
const MAX_LINE_CHARS: usize = 300;

/// The latest log lines, each with the seconds since the start of the server.
pub(crate) struct EventLog {
    begin: Instant,
    lines: VecDeque<String>,
    /// File that gets all lines, if there is one.
    file: Option<LogFile>,
    /// Warnings for the operator, from which [`EventLog::take_warnings`] has not taken them yet.
    warnings: Vec<String>,
}

/// Maximum number of warnings that wait for the operator; further ones are only logged.
const MAX_WARNINGS: usize = 100;

impl EventLog {
    /// Creates an empty log. Times count from now. Lines are also appended to the file at `path`.
    ///
    /// # Errors
    /// If the file cannot be opened.
    pub(super) fn new(path: Option<&Path>) -> io::Result<EventLog> {
        Ok(EventLog {
            begin: Instant::now(),
            lines: VecDeque::new(),
            file: path.map(LogFile::open).transpose()?,
            warnings: Vec::new(),
        })
    }

    /// Writes a line to the log, with the seconds since the start of the server.
    pub(crate) fn write(&mut self, what: fmt::Arguments<'_>) {
        self.write_line(Level::Info, what);
    }

    fn write_line(&mut self, level: Level, what: fmt::Arguments<'_>) {
        let message = what.to_string();
        let plain = message.chars().take(MAX_LINE_CHARS);
        let plain: String = plain
            .map(|c| if c.is_control() { ' ' } else { c })
            .collect();
        if let Some(file) = &self.file {
            file.write(level, &plain);
        }
        let seconds = self.begin.elapsed().as_secs_f64();
        self.lines.push_back(format!("{seconds:12.3} {plain}"));
        if self.lines.len() > MAX_LINES {
            self.lines.pop_front();
        }
    }

    /// Writes a line to the log and also stores it as a warning for the operator.
    pub(crate) fn warn(&mut self, what: &str) {
        self.write_line(Level::Warning, format_args!("{what}"));
        if self.warnings.len() < MAX_WARNINGS {
            self.warnings.push(what.to_owned());
        }
    }

    /// Removes and returns the warnings that were stored since the last call.
    pub(crate) fn take_warnings(&mut self) -> Vec<String> {
        std::mem::take(&mut self.warnings)
    }

    /// Returns the number of lines that are missing from the file.
    pub(crate) fn lost_lines(&self) -> u64 {
        self.file.as_ref().map_or(0, LogFile::lost)
    }

    /// Takes the file: lines are stored in memory only from now on. The file is closed when the caller drops it, without
    /// the lock of the state: that may wait for the disk.
    pub(crate) fn take_file(&mut self) -> Option<LogFile> {
        self.file.take()
    }

    /// Returns the text of all lines, oldest first.
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
        let mut log = EventLog::new(None).unwrap();
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
                .all(|l| l.chars().count() <= MAX_LINE_CHARS + 13)
        );
    }
}
