//! Reasons for rejecting requests to the core.

use core::fmt;

use crate::ids::CommandId;
use crate::lifecycle::CommandState;

/// Reason for which the core rejects a request. A rejected request changes nothing.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CommandError {
    /// The core has no command or rule with this id.
    Unknown,
    /// The command's lifecycle state, given here, does not allow the request.
    InvalidState(CommandState),
    /// A needed resource is held by another command, or needed by another command that the same rule starts.
    ResourceHeld {
        /// Number of the needed resource (actuator), as in the device bank.
        resource: u32,
        /// Command that holds or needs the resource.
        by: CommandId,
    },
    /// A rule would start a command after itself, or start one command twice.
    SelfSuccessor,
    /// The rule's condition can never become true.
    NeverFires,
    /// The rule's condition is nested too deeply.
    ConditionTooDeep,
    /// The command's period is not a whole multiple of the tick.
    PeriodMismatch,
    /// The table of commands or of rules is full, or the requested slot is occupied.
    TableFull,
}

impl fmt::Display for CommandError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CommandError::Unknown => f.write_str("unknown command or rule"),
            CommandError::InvalidState(state) => write!(f, "not allowed in state {state:?}"),
            CommandError::ResourceHeld { resource, .. } => {
                write!(f, "resource {resource} is held by another command")
            }
            CommandError::SelfSuccessor => {
                f.write_str("a command would follow itself or start twice")
            }
            CommandError::NeverFires => f.write_str("the rule can never fire"),
            CommandError::ConditionTooDeep => f.write_str("the condition is nested too deeply"),
            CommandError::PeriodMismatch => f.write_str("the period is not a multiple of the tick"),
            CommandError::TableFull => f.write_str("a table of the core is full"),
        }
    }
}

impl core::error::Error for CommandError {}
