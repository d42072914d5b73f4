//! The queues between the cycle and everybody else: bounded, and nobody ever waits at them.
//!
//! Nothing is lost: the cycle takes an order only while there is room to answer it, and leaves what it has to tell where it
//! is until there is room for it.

use std::sync::Arc;

use rpi_core::{Command, CommandId, Notice, Refused, Rule, RuleId, Why};
use rpi_sim::Part;
use rtrb::{Consumer, Producer, RingBuffer};

use super::board::Board;

/// Orders and reports that may wait.
const ROOM: usize = 4096;

/// What the cycle is asked to do between two ticks.
pub(crate) enum Order {
    /// Takes a command in.
    Insert(CommandId, Box<Command>, Arc<Board>),
    /// Starts a command.
    Start(CommandId),
    /// Asks a command to end.
    Cancel(CommandId),
    /// Ends a command by force.
    Abort(CommandId, Why),
    /// Gives a command back.
    Unload(CommandId),
    /// Makes a rule.
    Rule(RuleId, Box<Rule>),
    /// Drops a rule.
    Withdraw(RuleId),
    /// Sets inputs of commands, all between the same two cycles.
    Set(Box<[Setting]>),
    /// Puts a device into a place, or none.
    Device(usize, Option<Part>),
}

/// A value for an input.
pub(crate) struct Setting {
    pub(crate) command: CommandId,
    pub(crate) input: usize,
    pub(crate) value: Box<[u64]>,
}

/// What the cycle tells.
pub(crate) enum Report {
    /// What became of the order of this number.
    Answer(u64, Result<(), Refused>),
    /// Something has happened.
    Notice(Notice),
    /// A command is no more.
    Gone(CommandId, Spent),
    /// Something else is over.
    Spent(Spent),
}

/// What is over, to be freed where freeing disturbs nobody: nobody reads it any more.
#[expect(dead_code, reason = "it is moved only to be dropped elsewhere")]
pub(crate) enum Spent {
    Command(Box<Command>, Option<Arc<Board>>),
    Rule(Box<Rule>),
    Settings(Box<[Setting]>),
    Part(Part),
}

/// The cycle's ends.
pub(crate) struct CycleEnds {
    pub(crate) orders: Consumer<(u64, Order)>,
    pub(crate) reports: Producer<Report>,
}

/// The desk's ends.
pub(crate) struct DeskEnds {
    pub(crate) orders: Producer<(u64, Order)>,
    pub(crate) reports: Consumer<Report>,
}

pub(crate) fn links() -> (CycleEnds, DeskEnds) {
    let (to_cycle, orders) = RingBuffer::new(ROOM);
    let (reports, from_cycle) = RingBuffer::new(ROOM);
    let cycle = CycleEnds { orders, reports };
    let desk = DeskEnds {
        orders: to_cycle,
        reports: from_cycle,
    };
    (cycle, desk)
}
