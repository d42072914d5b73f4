//! How the tool ends, and where its text goes.

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::ExitCode;

/// Exit statuses.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Exit {
    /// Nothing to say against it.
    Good,
    /// Something was found.
    Found,
    /// A file or an option is wrong.
    BadInput,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(match exit {
            Exit::Good => 0,
            Exit::Found => 1,
            Exit::BadInput => 2,
        })
    }
}

/// A task's end; the error text is for people.
pub(crate) type Outcome = Result<Exit, Box<dyn std::error::Error>>;

/// Writes what was made of `source` like [`put`]; refuses to overwrite it.
pub(crate) fn put_result(
    source: &Path,
    output: Option<&Path>,
    bytes: &[u8],
) -> Result<(), Box<dyn std::error::Error>> {
    if let Some(path) = output
        && let (Ok(old), Ok(new)) = (source.canonicalize(), path.canonicalize())
        && old == new
    {
        return Err(format!("{}: this is the input; it would be lost", path.display()).into());
    }
    put(output, bytes)
}

/// Whether a file holds just this text: not one that is packed or in another encoding.
pub(crate) fn holds(path: &Path, text: &str) -> bool {
    fs::read(path).is_ok_and(|bytes| bytes == text.as_bytes())
}

/// Writes to a file, or to standard output without one. A reader that closes the pipe early is no error.
pub(crate) fn put(output: Option<&Path>, bytes: &[u8]) -> Result<(), Box<dyn std::error::Error>> {
    match output {
        Some(path) => fs::write(path, bytes).map_err(|e| format!("{}: {e}", path.display()).into()),
        None => match std::io::stdout().write_all(bytes) {
            Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(e.into()),
            _ => Ok(()),
        },
    }
}
