//! The control core: loading, the cycle, commands that follow one another without a gap.
//!
//! - [`Machine`] runs one image: its phases are the phases of a cycle, and [`Machine::step`] is one step of evaluation.
//! - [`Command`] is a machine with a life: [`State`], results, errors, the actuators that it holds.
//! - [`Core`] runs all commands that are due in a tick and decides once per tick what comes next.
//!
//! Loading allocates; nothing else does. No lock, no wait, no text and no unbounded loop is reachable from a tick.
//! This crate must not know a compiler, a file, a clock or a thread: devices and time are lent to it for each tick.
#![no_std]

extern crate alloc;

mod command;
mod commands;
mod lifecycle;
mod load;
mod machine;
mod ports;
mod program;
mod succession;
mod tick;

pub use command::{Cause, Command, Ending};
pub use commands::{CommandId, Core, Refused};
pub use lifecycle::{Event, Next, State};
pub use load::{LoadFault, catalogue};
pub use machine::{Machine, Moment, Verdict};
pub use tick::Watch;
