//! Errors of trace files.

use std::fmt;
use std::path::PathBuf;

/// Error: an invalid line in a trace file.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TraceError {
    /// Number of the invalid line, from 1.
    pub line: usize,
    /// Description of the error.
    pub message: String,
}

impl TraceError {
    pub(super) fn new(line: usize, message: impl Into<String>) -> TraceError {
        TraceError {
            line,
            message: message.into(),
        }
    }
}

impl fmt::Display for TraceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

/// Error: a trace or another text file cannot be read or has an invalid format.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct FileReadError {
    /// Path of the file.
    pub path: PathBuf,
    /// Number of the invalid line, from 1; `None` if the error concerns the whole file.
    pub line: Option<usize>,
    /// Description of the error.
    pub message: String,
}

impl fmt::Display for FileReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = self.line.map(|line| format!(":{line}")).unwrap_or_default();
        write!(f, "{}{line}: {}", self.path.display(), self.message)
    }
}

impl std::error::Error for FileReadError {}
