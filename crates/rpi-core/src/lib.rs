//! The control core: loads commands, runs their cycles, and switches between them without a gap.
//!
//! - [`Machine`] runs one image: its methods are the phases of a cycle, and [`Machine::step`] is one evaluation step.
//! - [`Command`] is a machine with a lifecycle: [`State`], results, errors, held resources.
//! - [`Rule`] stops, cancels and starts commands when a condition over results, errors and exported Booleans is true.
//! - [`Core`] runs all commands that are due in a tick, and fires rules once per tick.
//!
//! # Usage
//!
//! Outside the cycle: [`Command::load`] an image, allocate an id from [`Places`], build [`Rule`]s. Between two ticks,
//! on the thread of the cycle: [`Core::insert_as`], [`Core::start`], [`Core::schedule`], [`Core::cancel`],
//! [`Core::abort`], [`Core::remove`], and inputs through [`Core::command_mut`]. Each request takes effect at once or is
//! rejected with a reason ([`Refused`]). After each tick: [`Core::next_notice`] returns events; [`Core::take_gone`] and
//! [`Core::take_spent`] return finished commands and rules, to be freed outside the cycle. The invariants are numbered
//! in the manual's chapter on the control core.
//!
//! Only loading and building rules allocate. A tick reaches no lock, no wait, no text processing and no unbounded loop.
//! This crate does not depend on a compiler, files, clocks or threads: devices and time are passed to each tick.
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
