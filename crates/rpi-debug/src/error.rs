//! Errors of the debugger.

use std::fmt;

use rpi_record::mcap::RecordingError;

use crate::program::RecordedProgramError;

/// Error of the debugger.
#[derive(Debug)]
pub enum DebugError {
    /// The recording cannot be read or replayed.
    Recording(RecordingError),
    /// The program cannot be compiled again.
    Program(RecordedProgramError),
    /// There is no body of a command, fragment or node around this line.
    NoBody(u32),
    /// Too many expressions are watched; the maximum.
    TooManyExpressions(usize),
    /// The replay computes other values than the run did; what differs.
    Differs(String),
    /// An expression changes the run, because it faults or uses devices; what differs.
    ChangesRun(String),
    /// An expression reads a sensor that was not recorded, because the program did not read it; its name.
    NotRecorded(String),
}

impl fmt::Display for DebugError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DebugError::Recording(error) => error.fmt(f),
            DebugError::Program(error) => error.fmt(f),
            DebugError::NoBody(line) => write!(
                f,
                "line {line} is not inside of a command, fragment or node: there is nothing that an expression could read"
            ),
            DebugError::TooManyExpressions(most) => {
                write!(
                    f,
                    "at most {most} conditions and expressions can be watched"
                )
            }
            DebugError::Differs(what) => {
                write!(f, "the replay differs from the recording: {what}")
            }
            DebugError::ChangesRun(what) => write!(
                f,
                "the expression would change the run: it faults (by a division by zero, an overflow or an index), or uses a device: {what}"
            ),
            DebugError::NotRecorded(sensor) => write!(
                f,
                "the recording has no values of {sensor}, because the program did not read it"
            ),
        }
    }
}

impl std::error::Error for DebugError {}

impl From<RecordingError> for DebugError {
    fn from(error: RecordingError) -> Self {
        DebugError::Recording(error)
    }
}

impl From<RecordedProgramError> for DebugError {
    fn from(error: RecordedProgramError) -> Self {
        DebugError::Program(error)
    }
}
