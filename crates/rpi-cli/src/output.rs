//! Output of results to standard output and to files.

use std::io::{ErrorKind, Write};
use std::path::Path;

/// Writes `bytes` to standard output. A pipe that its reader has closed is not an error.
///
/// # Errors
/// Returns an error if standard output cannot be written for another reason.
pub fn print(bytes: impl AsRef<[u8]>) -> std::io::Result<()> {
    ignore_broken_pipe(std::io::stdout().write_all(bytes.as_ref())).map(|_| ())
}

/// Returns `None` if writing has failed because the reader has closed the pipe, which it may do at any time. Returns
/// `Some` with the result of a successful write.
///
/// # Errors
/// Returns all other errors of `written`.
pub fn ignore_broken_pipe<T>(written: std::io::Result<T>) -> std::io::Result<Option<T>> {
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(None),
        other => other.map(Some),
    }
}

/// Returns true if two paths name the same existing file. The tools use it to avoid overwriting their input files.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    }
}
