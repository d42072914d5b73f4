//! Exit status of the tool.

use std::process::ExitCode;

/// Exit status after a crash of the control core.
pub(crate) const CRASHED: u8 = 4;

/// Exit status of `rpi`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Exit {
    /// Status 0: the tool has succeeded.
    Success,
    /// Status 1: a command ended with an error, or a replay differs from the recorded trace.
    CommandError,
    /// Status 2: a file, an option or a program is invalid.
    BadInput,
    /// Status 3: a fault occurred while a command ran.
    Fault,
    /// Status 4: the control core has crashed.
    Crashed,
    /// Status of the control core that a guard has watched until its end in order.
    Core {
        /// Exit status of the process of the core.
        status: u8,
    },
    /// Status 128 + signal number: a signal interrupted the tool.
    Interrupted {
        /// Number of the signal: 1 for SIGHUP, 2 for SIGINT, 15 for SIGTERM.
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
            Exit::Crashed => CRASHED,
            Exit::Core { status } => status,
            Exit::Interrupted { signal } => 128 + signal,
        })
    }
}

/// Result of a subcommand: the exit status, or an error that is printed for the user.
pub(crate) type CommandResult = rpi_cli::CommandResult<Exit>;
