//! Log file: each event as a line of JSON, in a file that outlives the server.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

use serde_json::json;
use time::OffsetDateTime;
use time::format_description::well_known::Rfc3339;

/// Number of lines that may wait for a slow disk. More are lost and counted: the log must not hold up the server.
const WAITING_LINES: usize = 1024;

/// Severity of a log line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Level {
    /// Something that happens in normal operation.
    Info,
    /// Something that an operator should look at.
    Warning,
}

impl Level {
    fn name(self) -> &'static str {
        match self {
            Level::Info => "info",
            Level::Warning => "warning",
        }
    }
}

/// Log file, written by a thread of its own. Dropping it writes the waiting lines and closes the file.
pub(crate) struct LogFile {
    /// `None` only while the file is being closed.
    lines: Option<SyncSender<String>>,
    /// Number of lines that were lost because the disk was too slow, or not writable.
    lost: Arc<AtomicU64>,
    writer: Option<JoinHandle<()>>,
}

impl LogFile {
    /// Opens the file for appending, and starts its writer.
    ///
    /// # Errors
    /// If the file or the thread cannot be created.
    pub(super) fn open(path: &Path) -> io::Result<LogFile> {
        let file = OpenOptions::new().create(true).append(true).open(path)?;
        let (sender, lines) = sync_channel(WAITING_LINES);
        let lost = Arc::<AtomicU64>::default();
        let counter = Arc::clone(&lost);
        let writer = thread::Builder::new()
            .name("rpi-log".into())
            .spawn(move || write_all(file, &lines, &counter))?;
        Ok(LogFile {
            lines: Some(sender),
            lost,
            writer: Some(writer),
        })
    }

    /// Writes a line with the current time. Does not wait.
    pub(super) fn write(&self, level: Level, message: &str) {
        // The formatting of a valid time with this format cannot fail.
        let now = OffsetDateTime::now_utc().format(&Rfc3339);
        let line = json!({
            "time": now.unwrap_or_default(),
            "level": level.name(),
            "message": message,
        });
        let sent = self.lines.as_ref().map(|s| s.try_send(format!("{line}\n")));
        if !matches!(sent, Some(Ok(()))) {
            self.lost.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Returns the number of lines that could not be written.
    pub(super) fn lost(&self) -> u64 {
        self.lost.load(Ordering::Relaxed)
    }
}

impl Drop for LogFile {
    fn drop(&mut self) {
        // Without a sender the writer ends behind the last line.
        self.lines = None;
        if let Some(writer) = self.writer.take() {
            let _ = writer.join();
        }
    }
}

/// Writes lines until all senders are gone. A line that cannot be written is counted, and the next one is tried: a full
/// disk may have room again.
fn write_all(mut file: File, lines: &Receiver<String>, lost: &AtomicU64) {
    for line in lines {
        if file.write_all(line.as_bytes()).is_err() {
            lost.fetch_add(1, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_appended_and_all_written_at_the_end() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("server.log");
        for round in 0..2 {
            let log = LogFile::open(&path).unwrap();
            log.write(Level::Info, &format!("start {round}"));
            log.write(Level::Warning, "a \"quoted\"\nline");
            assert_eq!(log.lost(), 0);
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let lines: Vec<serde_json::Value> = text
            .lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect();
        assert_eq!(lines.len(), 4);
        assert_eq!(lines[2]["message"], "start 1");
        assert_eq!(lines[1]["message"], "a \"quoted\"\nline");
        assert_eq!(lines[1]["level"], "warning");
        let time = lines[0]["time"].as_str().unwrap();
        assert!(OffsetDateTime::parse(time, &Rfc3339).is_ok());
    }
}
