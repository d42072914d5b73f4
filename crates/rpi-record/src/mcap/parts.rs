//! The files of a recording: one, or several parts of limited size and duration.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::mcap_file::Output;

/// Limits of one part (file) of a recording. When a part reaches one of them, it is closed, and the next part begins.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct PartLimits {
    /// Maximum size of a part in bytes, exact to the length of a chunk (1 MiB before compression); `None` for no limit.
    pub bytes: Option<u64>,
    /// Maximum duration of a part, in the time of the run; `None` for no limit.
    pub time: Option<Duration>,
}

/// Function that opens the output of the part with this number. Parts are numbered from 1.
pub type OpenPart = Box<dyn FnMut(u32) -> io::Result<Box<dyn Output>> + Send>;

/// Number of the first part of a recording.
pub(super) const FIRST_PART: u32 = 1;

/// Returns the path of the file for a part of a recording: the first part has the path of the recording, the others
/// have their number before the extension (`out.mcap`, `out.0002.mcap`, ...).
#[must_use]
pub fn part_path(recording: &Path, part: u32) -> PathBuf {
    match part {
        FIRST_PART => recording.to_owned(),
        _ => recording.with_extension(format!("{part:04}.mcap")),
    }
}

/// Returns the function that opens the parts of a recording as files. `first` is the open file of the first part.
#[must_use]
pub fn part_files(recording: &Path, first: File) -> OpenPart {
    let (recording, mut first) = (recording.to_owned(), Some(first));
    Box::new(move |part| {
        let file = match first.take() {
            Some(file) => file,
            None => File::create(part_path(&recording, part))?,
        };
        Ok(Box::new(BufWriter::new(file)))
    })
}

/// Returns the function that opens a recording with a single output. It fails for a second part.
#[must_use]
pub fn single_part(out: impl Output + 'static) -> OpenPart {
    let mut out: Option<Box<dyn Output>> = Some(Box::new(out));
    Box::new(move |_| {
        out.take()
            .ok_or_else(|| io::Error::other("the recording has a single output"))
    })
}
