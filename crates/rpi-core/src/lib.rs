//! The control core: loads commands, runs their cycles, and switches between them without a gap.
//!
//! - [`Instance`] runs one image: its methods are the phases of a cycle, and [`Instance::step`] is one evaluation step.
//! - [`Command`] is a machine with a lifecycle: [`CommandState`], results, errors, held resources.
//! - [`Rule`] stops, cancels and starts commands when a condition over results, errors and exported Booleans is true.
//! - [`Core`] runs all commands that are due in a tick, and fires rules once per tick.
//!
//! # Usage
//!
//! Outside the cycle: [`Command::load`] an image, allocate an id from [`IdAllocator`], build [`Rule`]s. Between two ticks,
//! on the thread of the cycle: [`Core::insert_with_id`], [`Core::start`], [`Core::schedule`], [`Core::cancel`],
//! [`Core::abort`], [`Core::remove`], and inputs through [`Core::command_mut`]. Each request takes effect at once or is
//! rejected with a reason ([`CommandError`]). After each tick: [`Core::next_notice`] returns events; [`Core::take_orphan`] and
//! [`Core::take_finished_rule`] return finished commands and rules, to be freed outside the cycle. The invariants are numbered
//! in the manual's chapter on the control core.
//!
//! Only loading and building rules allocate. A tick reaches no lock, no wait, no text processing and no unbounded loop.
//! This crate does not depend on a compiler, files, clocks or threads: devices and time are passed to each tick.
#![no_std]

extern crate alloc;

mod command;
mod command_set;
mod command_table;
mod condition;
mod continuity;
mod control_core;
mod cycle_context;
mod decision;
mod error;
mod facts;
mod ids;
mod instance;
mod lifecycle;
mod load;
mod notice;
mod overrun;
mod ports;
mod program;
mod resources;
mod rule;
mod rule_codec;
mod rule_table;
mod schedule;
mod takeover;
mod tick;
mod work_bound;

pub use command::{AbortReason, Cause, Command, Ending};
pub use condition::{Condition, Fact};
pub use continuity::Continuity;
pub use control_core::Core;
pub use cycle_context::{CycleContext, MotionControls};
pub use error::CommandError;
pub use ids::{CommandId, IdAllocator, RuleId};
pub use instance::{Instance, Verdict};
pub use lifecycle::{CommandEvent, CommandState, Transition};
pub use load::{LoadError, prim_desc};
pub use notice::{Notice, RuleOutcome};
pub use overrun::{
    CommandOverrunPolicy, Overrun, OverrunStats, OverrunThreshold, ParseOverrunPolicyError,
};
pub use rule::Rule;
pub use tick::CycleObserver;
