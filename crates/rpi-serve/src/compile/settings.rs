//! Configuration of the compilation.

use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Duration;

/// Process in which the texts of clients are compiled.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub enum CompilerSettings {
    /// The process of the server, one text at a time. A text that takes much memory takes it from the server.
    #[default]
    InProcess,
    /// Worker processes with limits, one per text.
    Workers(WorkerSettings),
}

/// Worker processes and their limits.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct WorkerSettings {
    /// Program that calls [`run_compile_worker`](crate::run_compile_worker) when it is started with `arguments`. It
    /// must be of the same build as the server.
    pub program: PathBuf,
    /// Arguments of the program.
    pub arguments: Vec<OsString>,
    /// Maximum number of workers at a time. Further loads wait.
    pub processes: usize,
    /// Maximum address space of a worker in bytes.
    pub memory_bytes: u64,
    /// Time from the start of a worker until it is killed.
    pub timeout: Duration,
}

impl WorkerSettings {
    /// Creates the settings for a program with the default limits: 4 workers of 1 GiB, 60 s for a text.
    #[must_use]
    pub fn new(program: PathBuf, arguments: Vec<OsString>) -> WorkerSettings {
        WorkerSettings {
            program,
            arguments,
            processes: 4,
            memory_bytes: 1 << 30,
            timeout: Duration::from_secs(60),
        }
    }
}
