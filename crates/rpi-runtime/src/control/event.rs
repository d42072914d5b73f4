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
        /// Ticket of the request.
        ticket: Ticket,
        /// First tick affected by the request.
        tick: u64,
        /// Reason of the refusal, if any. A refused request has no effect.
        refused: Option<CommandError>,
    },
    /// A command or rule has changed its state.
    Notice(Notice),
    /// A command was freed. Its identifier is no longer valid.
    Freed(CommandId),
    /// The state of a device has changed.
    Device {
        /// Index of the device in the cell.
        device: usize,
        /// Error code of the device; 0 for none.
        code: i64,
        /// Whether the device moves.
        moving: bool,
        /// Tick after which the device has this state.
        tick: u64,
    },
}

/// A request that the host rejected before sending it to the cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum RequestError {
    /// The command does not exist, or it is being unloaded.
    UnknownCommand,
    /// The command table is full.
    TableFull,
    /// Too many requests or rules are pending. The caller must wait for answers.
    QueueFull,
    /// The memory quota of the requester is exhausted.
    OutOfMemoryQuota,
    /// The command exceeds the time budget of a tick.
    BudgetExceeded(BudgetExceededError),
    /// The command cannot run in this cell, for these reasons.
    Load(Vec<LoadError>),
    /// The value has the wrong size for its input.
    ValueSize {
        /// Command with the input.
        command: CommandId,
        /// Index of the input.
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
