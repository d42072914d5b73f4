//! Errors of reading and replaying recordings.

use std::fmt;

use rpi_diag::Code;

/// Error: a recording cannot be read or replayed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum RecordingError {
    /// The file is not a valid MCAP file: it is damaged, or too short to contain a record.
    Damaged(String),
    /// The file is valid MCAP, but was not written by RPI or has an unsupported version; the text says what is wrong.
    NotRpi(String),
    /// The file cannot be read; the text is the reason.
    Unreadable(String),
    /// The requests, events and images of the recording together are larger than this number of bytes.
    TooLarge(usize),
    /// The requested ticks of the recording have more values than this number.
    TooLong(usize),
    /// The recording lacks a part that is needed for reading it; the text names the part.
    Missing(String),
    /// The recording was cut out of a longer one, so that it cannot be replayed; the time of its first tick in ns since the start of
    /// the run.
    Excerpt(u64),
    /// The recording was merged from several; the names of their files.
    Merged(String),
    /// A new recording cannot be written; the text is the reason.
    Unwritable(String),
}

impl RecordingError {
    /// Returns the code of the error in the table of diagnostics, under which the manual explains it.
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
                write!(f, "the recording is damaged: {why}")
            }
            RecordingError::NotRpi(what) => write!(f, "this is not an RPI recording: {what}"),
            RecordingError::Unreadable(why) => write!(f, "the recording cannot be read: {why}"),
            RecordingError::TooLarge(limit) => write!(
                f,
                "the recording is too large to be replayed: its requests, events and images have more than {} MiB",
                limit >> 20
            ),
            RecordingError::TooLong(limit) => write!(
                f,
                "the recording is too long: it has more than {limit} values; select a shorter time"
            ),
            RecordingError::Excerpt(from) => write!(
                f,
                "the recording begins {:.3} s after the start of the run and cannot be replayed: the state of the core at that time is \
                 unknown; replay the recording that it was cut out of, or cut it from 0 on (`rpi recording cut FILE --to TIME`)",
                *from as f64 * 1e-9
            ),
            RecordingError::Merged(files) => write!(
                f,
                "the recording is merged from {files}: it is for viewers of MCAP and cannot be replayed; use the recordings that it was \
                 made of"
            ),
            RecordingError::Unwritable(why) => {
                write!(f, "the new recording cannot be written: {why}")
            }
            RecordingError::Missing(what) => write!(f, "the recording has no {what}"),
        }
    }
}

impl std::error::Error for RecordingError {}
