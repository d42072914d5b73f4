//! Events from the cycle to the host.

use std::fmt;

use super::admission::TooMuch;
use rpi_core::{CommandId, LoadFault, Notice, Refused};

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
        refused: Option<Refused>,
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
pub enum Rejected {
    /// The command does not exist, or it is being unloaded.
    Unknown,
    /// The command table is full.
    Full,
    /// Too many requests or rules are pending. The caller must wait for answers.
    Busy,
    /// The memory quota of the requester is exhausted.
    Memory,
    /// The command exceeds the time budget of a tick.
    TooMuch(TooMuch),
    /// The command cannot run in this cell; all load errors.
    Loading(Vec<LoadFault>),
    /// The value has the wrong size for its input.
    Value {
        /// Command with the input.
        command: CommandId,
        /// Index of the input.
        input: usize,
    },
}

impl fmt::Display for Rejected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Rejected::Unknown => f.write_str("unknown command"),
            Rejected::Full => f.write_str("the command table is full"),
            Rejected::Busy => f.write_str("too many pending requests"),
            Rejected::Memory => f.write_str("the memory quota is exhausted"),
            Rejected::TooMuch(why) => why.fmt(f),
            Rejected::Loading(faults) => {
                f.write_str("the command cannot run in this cell:")?;
                faults.iter().try_for_each(|fault| write!(f, "\n  {fault}"))
            }
            Rejected::Value { input, .. } => {
                write!(f, "the value has the wrong size for input {input}")
            }
        }
    }
}

impl From<TooMuch> for Rejected {
    fn from(why: TooMuch) -> Rejected {
        Rejected::TooMuch(why)
    }
}

impl std::error::Error for Rejected {}
