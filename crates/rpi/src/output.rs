//! Output files.

use std::error::Error;
use std::fs::File;
use std::path::Path;

/// Creates an output file. Returns an error if the file is one of `sources`, the input files of the run, because it
/// would be overwritten.
pub(crate) fn create(path: &Path, sources: &[&Path]) -> Result<File, Box<dyn Error>> {
    if sources
        .iter()
        .any(|source| rpi_cli::is_same_file(path, source))
    {
        return Err(format!("{}: cannot overwrite the input file", path.display()).into());
    }
    File::create(path).map_err(|e| format!("{}: {e}", path.display()).into())
}
