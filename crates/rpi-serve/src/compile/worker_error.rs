//! Errors of worker processes, as reported to the client whose text was compiled.

use std::fmt;
use std::time::Duration;

use super::answer::AnswerError;

/// Error: a worker process has not compiled its text.
#[derive(Debug)]
pub(crate) enum WorkerError {
    /// The worker cannot be started, or a pipe to it failed.
    Io(std::io::Error),
    /// The text took longer than this time.
    Timeout(Duration),
    /// The text needed more than this number of bytes.
    Memory(u64),
    /// The worker ended without an answer; the text is its exit status.
    Ended(String),
    /// The answer is invalid.
    Answer(AnswerError),
    /// The client has disconnected, or the server closes.
    Cancelled,
    /// No worker was free in time.
    Busy,
}

impl fmt::Display for WorkerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let code = rpi_diag::Code::RPI9202;
        match self {
            WorkerError::Io(why) => write!(
                f,
                "{code}: the compiler process cannot be started or reached: {why}; try again, or start the server with `--in-process`"
            ),
            WorkerError::Timeout(time) => write!(
                f,
                "{code}: compiling the text takes longer than {} s; divide it into smaller commands, or raise `--load-timeout`",
                time.as_secs_f64()
            ),
            WorkerError::Memory(bytes) => write!(
                f,
                "{code}: compiling the text needs more than {} MiB of memory; divide it into smaller commands",
                bytes >> 20
            ),
            WorkerError::Ended(status) => write!(
                f,
                "{code}: the compiler process ended without an answer ({status}); load the text again"
            ),
            WorkerError::Answer(why) => write!(
                f,
                "{code}: the compiler process gave an invalid answer: {why}; start the server again if its program was replaced"
            ),
            WorkerError::Cancelled => f.write_str("the client has disconnected"),
            WorkerError::Busy => {
                write!(f, "{code}: all compiler processes are busy; try again")
            }
        }
    }
}

impl std::error::Error for WorkerError {}
