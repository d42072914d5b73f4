//! Errors of reading and replaying recordings.

use std::fmt;

use rpi_diag::Code;

/// Error: a recording cannot be read or replayed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum RecordingError {
    /// The file is not a valid MCAP file: it is truncated or damaged.
    Damaged(String),
    /// The file is valid MCAP, but was not written by RPI or has an unsupported format version.
    NotRpi(String),
    /// The recording lacks a part that is needed; the text names it.
    Missing(String),
}

impl RecordingError {
    /// Returns the code of the error in the manual.
    #[must_use]
    pub fn code(&self) -> Code {
        Code::RPI9021
    }
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.code())?;
        match self {
            RecordingError::Damaged(why) => {
                write!(f, "the recording is truncated or damaged: {why}")
            }
            RecordingError::NotRpi(what) => write!(f, "this is not an RPI recording: {what}"),
            RecordingError::Missing(what) => write!(f, "the recording has no {what}"),
        }
    }
}

impl std::error::Error for RecordingError {}
