//! What the host hears from the cycle.

use std::fmt;

use super::admission::TooMuch;
use rpi_core::{CommandId, LoadFault, Notice, Refused};

/// A request under way.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Ticket(pub u64);

/// Something that has happened, in order.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Event {
    /// A request was carried out or refused.
    Answer {
        /// Which.
        ticket: Ticket,
        /// The first tick that it counts for.
        tick: u64,
        /// Why it was refused, if it was; nothing has changed then.
        refused: Option<Refused>,
    },
    /// Something happened to a command or a rule.
    Notice(Notice),
    /// A command has been freed; its name means nothing any more.
    Freed(CommandId),
    /// The state of a device has changed.
    Device {
        /// Its place in the cell.
        device: usize,
        /// What is wrong with it, 0 if it is well.
        code: i64,
        /// Whether it moves.
        moving: bool,
        /// The tick after which it is so.
        tick: u64,
    },
}

/// Why a request did not even leave for the cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Rejected {
    /// There is no such command, or it is being unloaded.
    Unknown,
    /// All places for commands are taken.
    Full,
    /// More requests or rules are under way than the queue holds; some must be answered first.
    Busy,
    /// Whoever wants it has no memory left for it.
    Memory,
    /// It takes more of a tick than commands may.
    TooMuch(TooMuch),
    /// It cannot run in this cell: every reason.
    Loading(Vec<LoadFault>),
    /// A value does not fit its input.
    Value {
        /// The command.
        command: CommandId,
        /// The input's index.
        input: usize,
    },
}

impl fmt::Display for Rejected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Rejected::Unknown => f.write_str("there is no such command"),
            Rejected::Full => f.write_str("all places for commands are taken"),
            Rejected::Busy => f.write_str("too many requests are under way"),
            Rejected::Memory => f.write_str("there is no memory left for it"),
            Rejected::TooMuch(why) => why.fmt(f),
            Rejected::Loading(faults) => {
                f.write_str("it cannot run in this cell:")?;
                faults.iter().try_for_each(|fault| write!(f, "\n  {fault}"))
            }
            Rejected::Value { input, .. } => write!(f, "the value does not fit input {input}"),
        }
    }
}

impl From<TooMuch> for Rejected {
    fn from(why: TooMuch) -> Rejected {
        Rejected::TooMuch(why)
    }
}

impl std::error::Error for Rejected {}
