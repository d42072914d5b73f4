//! Why a recording cannot be run again.

use std::fmt;

use rpi_diag::Code;

/// Why a recording cannot be run again.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum RecordingError {
    /// It is no MCAP file, or does not go on as one: it was cut off, or bytes of it have changed.
    Broken(String),
    /// It is one, but not of ours, or of another form.
    Foreign(String),
    /// Something that is needed is not in it.
    Missing(String),
}

impl RecordingError {
    /// The code under which the manual speaks of it.
    #[must_use]
    pub fn code(&self) -> Code {
        Code::RPI9021
    }
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.code())?;
        match self {
            RecordingError::Broken(why) => {
                write!(f, "the recording is cut off or damaged: {why}")
            }
            RecordingError::Foreign(what) => write!(f, "this is no recording of ours: {what}"),
            RecordingError::Missing(what) => write!(f, "the recording has no {what}"),
        }
    }
}

impl std::error::Error for RecordingError {}
