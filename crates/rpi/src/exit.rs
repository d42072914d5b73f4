//! How the tool ends.

use std::process::ExitCode;

/// Exit statuses.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Exit {
    /// As asked for.
    Good,
    /// The command ended with its error, or a trace differs.
    CommandError,
    /// A file, an option or a program is wrong.
    BadInput,
    /// A fault while running.
    Fault,
    /// Somebody has interrupted it by a signal of this number.
    Interrupted {
        /// The number: 2 for SIGINT, 15 for SIGTERM.
        signal: u8,
    },
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(match exit {
            Exit::Good => 0,
            Exit::CommandError => 1,
            Exit::BadInput => 2,
            Exit::Fault => 3,
            Exit::Interrupted { signal } => 128 + signal,
        })
    }
}

/// A task's end; the error text is for people.
pub(crate) type Outcome = Result<Exit, Box<dyn std::error::Error>>;
