//! The control core: loading, the cycle, commands that follow one another without a gap.
//!
//! - [`Machine`] runs one image: its phases are the phases of a cycle, and [`Machine::step`] is one step of evaluation.
//! - [`Command`] is a machine with a life: [`State`], results, errors, the actuators that it holds.
//! - [`Rule`] says when which commands are stopped, cancelled and started: by results, errors and exported Booleans.
//! - [`Core`] runs all commands that are due in a tick and decides once per tick what comes next.
//!
//! # Using it
//!
//! Beside the cycle: [`Command::load`] an image, give it a name with [`Places`], make [`Rule`]s. Between two ticks, on the
//! cycle's thread: [`Core::insert_as`], [`Core::start`], [`Core::schedule`], [`Core::cancel`], [`Core::abort`],
//! [`Core::remove`], inputs by [`Core::command_mut`]; each takes effect at once or is [`Refused`] with the reason. After
//! each tick: [`Core::next_notice`] tells what happened, [`Core::take_gone`] and [`Core::take_spent`] give back what is over,
//! to be freed beside the cycle. The rules that hold are numbered in the book's chapter on the control core.
//!
//! Loading and making rules allocate; nothing else does. No lock, no wait, no text and no unbounded loop is reachable from a
//! tick. This crate must not know a compiler, a file, a clock or a thread: devices and time are lent to it for each tick.
#![no_std]

extern crate alloc;

mod command;
mod commands;
mod condition;
mod continuity;
mod facts;
mod id;
mod lifecycle;
mod load;
mod machine;
mod names;
mod notice;
mod overrun;
mod ports;
mod program;
mod resources;
mod rule;
mod scheduling;
mod switch;
mod tick;
mod weight;
mod words;

pub use command::{Cause, Command, Ending, Why};
pub use commands::{Core, Refused};
pub use condition::{Condition, Fact};
pub use continuity::Continuity;
pub use id::{CommandId, Places, RuleId};
pub use lifecycle::{Event, Next, State};
pub use load::{LoadFault, catalogue};
pub use machine::{Machine, Moment, Verdict};
pub use notice::{Notice, Outcome};
pub use overrun::{NoPolicy, Often, OnOverrun, Overrun, Overruns};
pub use rule::Rule;
pub use tick::Watch;
