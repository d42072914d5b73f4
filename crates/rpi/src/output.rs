//! Where results go: standard output, and files that are not what was read.

use std::error::Error;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Writes to standard output. A reader that closes the pipe early is no error.
pub(crate) fn put(text: &str) -> std::io::Result<()> {
    quietly(std::io::stdout().write_all(text.as_bytes())).map(|_| ())
}

/// Whether all was written; a pipe that its reader has closed takes no more, which is no error.
pub(crate) fn quietly<T>(written: std::io::Result<T>) -> std::io::Result<Option<T>> {
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(None),
        other => other.map(Some),
    }
}

/// Makes a file for results; refuses to overwrite what they come from.
pub(crate) fn create(path: &Path, sources: &[&Path]) -> Result<File, Box<dyn Error>> {
    for source in sources {
        refuse(path, source)?;
    }
    File::create(path).map_err(|e| format!("{}: {e}", path.display()).into())
}

fn refuse(path: &Path, source: &Path) -> Result<(), String> {
    let same = match (path.canonicalize(), source.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    };
    match same {
        true => Err(format!(
            "{}: this is the input; it would be lost",
            path.display()
        )),
        false => Ok(()),
    }
}
