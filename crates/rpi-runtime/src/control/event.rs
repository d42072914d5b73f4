//! Events from the cycle to the host.

use std::fmt;

use super::admission::BudgetExceededError;
use rpi_core::{CommandError, CommandId, LoadError, Notice};

/// Number of a request. The [`Event::Answer`] to the request carries the same number.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Ticket(pub u64);

/// An event of the control core. Events are delivered in order.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Event {
    /// A request was carried out or refused.
    Answer {
        /// Ticket that the host received when it made the request.
        ticket: Ticket,
        /// Number of the first tick in which the request has an effect.
        tick: u64,
        /// Reason of the refusal, if any. A refused request has no effect.
        refused: Option<CommandError>,
    },
    /// Event of a command or a rule, such as a start, an end, or a discontinuity at a takeover.
    Notice(Notice),
    /// A command was freed. Its identifier is no longer valid.
    Freed(CommandId),
    /// The error code of a device has changed, or the device has started or stopped moving.
    Device {
        /// Index of the device in the device bank, from 0.
        device: usize,
        /// Error code of the device; 0 for none.
        code: i64,
        /// Whether the device moves.
        moving: bool,
        /// Number of the tick at whose end the device reported this state.
        tick: u64,
    },
}

/// A request that the host rejected before sending it to the cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum RequestError {
    /// The command does not exist, or it is being unloaded.
    UnknownCommand,
    /// The control core already has the maximum number of commands.
    TableFull,
    /// The queue has no room for the request, or the core has the maximum number of rules. The caller must wait for
    /// answers.
    QueueFull,
    /// The memory quota of the client or task that made the request is exhausted.
    OutOfMemoryQuota,
    /// The commands that could run in the same tick would exceed the time budget of a tick.
    BudgetExceeded(BudgetExceededError),
    /// The command cannot run in this cell; the list has all reasons.
    Load(Vec<LoadError>),
    /// The value for an input of a command has the wrong number of memory words.
    ValueSize {
        /// Id of the command whose input was to be set.
        command: CommandId,
        /// Index of the input in the image, from 0.
        input: usize,
    },
}

impl fmt::Display for RequestError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RequestError::UnknownCommand => f.write_str("unknown command"),
            RequestError::TableFull => f.write_str("the command table is full"),
            RequestError::QueueFull => f.write_str("too many pending requests"),
            RequestError::OutOfMemoryQuota => f.write_str("the memory quota is exhausted"),
            RequestError::BudgetExceeded(why) => why.fmt(f),
            RequestError::Load(faults) => {
                f.write_str("the command cannot run in this cell:")?;
                faults.iter().try_for_each(|fault| write!(f, "\n  {fault}"))
            }
            RequestError::ValueSize { input, .. } => {
                write!(f, "the value has the wrong size for input {input}")
            }
        }
    }
}

impl From<BudgetExceededError> for RequestError {
    fn from(why: BudgetExceededError) -> RequestError {
        RequestError::BudgetExceeded(why)
    }
}

impl std::error::Error for RequestError {}
