//! Exit status of the tool and output of its results.

use std::fs;
use std::path::Path;
use std::process::ExitCode;

/// Exit status of `rpic`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Exit {
    /// Status 0: no errors were reported.
    Success,
    /// Status 1: errors in programs were reported, or a test has failed.
    ErrorsReported,
    /// Status 2: a file cannot be read or written, or an option is invalid.
    BadInput,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(match exit {
            Exit::Success => 0,
            Exit::ErrorsReported => 1,
            Exit::BadInput => 2,
        })
    }
}

/// Result of a subcommand: the exit status, or an error with a message for people.
pub(crate) type CommandResult = rpi_cli::CommandResult<Exit>;

/// Writes a result like [`write_output`], but returns an error if `output` is the file `source` from which the result
/// was computed.
pub(crate) fn write_result(
    source: &Path,
    output: Option<&Path>,
    bytes: &[u8],
) -> Result<(), Box<dyn std::error::Error>> {
    if let Some(path) = output
        && rpi_cli::is_same_file(source, path)
    {
        return Err(format!(
            "{}: this is the input file; refusing to overwrite it",
            path.display()
        )
        .into());
    }
    write_output(output, bytes)
}

/// Returns whether the bytes of a file are exactly this text; false for a compressed file or one in another encoding.
pub(crate) fn file_equals(path: &Path, text: &str) -> bool {
    fs::read(path).is_ok_and(|bytes| bytes == text.as_bytes())
}

/// Writes `bytes` to the file `output`, or to standard output if `output` is `None`. A closed pipe is not an error.
pub(crate) fn write_output(
    output: Option<&Path>,
    bytes: &[u8],
) -> Result<(), Box<dyn std::error::Error>> {
    match output {
        Some(path) => fs::write(path, bytes).map_err(|e| format!("{}: {e}", path.display()).into()),
        None => Ok(rpi_cli::print(bytes)?),
    }
}
