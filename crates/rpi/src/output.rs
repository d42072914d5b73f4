//! Output of results to standard output and to files.

use std::error::Error;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Writes to standard output. A pipe closed by its reader is no error.
pub(crate) fn print(text: &str) -> std::io::Result<()> {
    ignore_broken_pipe(std::io::stdout().write_all(text.as_bytes())).map(|_| ())
}

/// Turns a broken pipe into `None`, as a reader may close a pipe at any time.
pub(crate) fn ignore_broken_pipe<T>(written: std::io::Result<T>) -> std::io::Result<Option<T>> {
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(None),
        other => other.map(Some),
    }
}

/// Creates an output file. Returns an error if the file is one of the inputs `sources`.
pub(crate) fn create(path: &Path, sources: &[&Path]) -> Result<File, Box<dyn Error>> {
    if sources.iter().any(|source| is_same_file(path, source)) {
        return Err(format!("{}: cannot overwrite the input file", path.display()).into());
    }
    File::create(path).map_err(|e| format!("{}: {e}", path.display()).into())
}

/// Returns whether both paths exist and lead to the same file.
fn is_same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    }
}
