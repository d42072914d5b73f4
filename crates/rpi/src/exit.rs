//! Exit status of the tool.

use std::process::ExitCode;

/// Exit status.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Exit {
    /// The tool has succeeded.
    Success,
    /// A command ended with an error, or a trace differs.
    CommandError,
    /// A file, an option or a program is invalid.
    BadInput,
    /// A fault occurred while a command ran.
    Fault,
    /// The tool was interrupted by a signal.
    Interrupted {
        /// Signal number: 2 for SIGINT, 15 for SIGTERM.
        signal: u8,
    },
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(match exit {
            Exit::Success => 0,
            Exit::CommandError => 1,
            Exit::BadInput => 2,
            Exit::Fault => 3,
            Exit::Interrupted { signal } => 128 + signal,
        })
    }
}

/// Result of a subcommand. The error is printed for the user.
pub(crate) type CommandResult = rpi_cli::CommandResult<Exit>;
