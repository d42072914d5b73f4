//! Control core in operation: the interface by which host programs control running commands.
//!
//! ```text
//! Control (host side, one owner)          Executive (cycle's side)
//!   load, start, schedule, cancel,  --->    takes requests, ticks the core, steps the devices
//!   abort, unload, set, subscribe   <---    events, samples, and objects to be freed by the host
//! ```
//! [`open`] creates both sides. They communicate only through bounded queues on which neither side blocks: the
//! executive takes a bounded number of requests per tick and never allocates or frees; [`Control`] allocates, loads and
//! frees.
//!
//! # The interface
//!
//! | task | call | answer |
//! |---|---|---|
//! | load an image | [`Control::load`], or [`Control::adopt`] for a command loaded elsewhere | its [`CommandId`], or all load errors |
//! | start, cancel, abort, unschedule | [`Control::start`], [`cancel`](Control::cancel), [`abort`](Control::abort), [`unschedule`](Control::unschedule) | a [`Ticket`] |
//! | schedule a command after another one, or by any rule | [`Control::schedule`] with a [`Rule`] | a [`RuleId`] and a [`Ticket`] |
//! | unload a command | [`Control::unload`] | a [`Ticket`], then [`Event::Freed`] |
//! | set inputs of any commands between the same two cycles | [`Control::set`] | a [`Ticket`] |
//! | observe exported flows | [`Control::subscribe`], then [`Control::samples`] | a sample for each change of a value |
//! | poll the exports of a command | [`Control::adopt_with_snapshot`] | a [`ExportSnapshot`] |
//! | insert or remove a device | [`Control::replace_device`] | a [`Ticket`] |
//! | set the override and the pause of all motions | [`Control::set_controls`] | a [`Ticket`] |
//! | stop everything | [`Control::emergency_stop`] | a [`Ticket`] |
//! | receive events | [`Control::poll`] | [`Event`]s in order |
//! | inspect a command | [`Control::get`] | [`CommandInfo`]: image, state, ending |
//!
//! Every ticket is answered by one [`Event::Answer`]. Requests are carried out in the order in which they were made, so
//! a command can be loaded, named in a rule and started without waiting in between. [`CommandInfo::state`] is updated by the
//! events that the host has polled. A command that has ended stays loaded until it is unloaded. A command that nothing
//! can start any more, and that was not to be kept, unloads itself and is reported by [`Event::Freed`].
//!
//! ```
//! use rpi_core::Rule;
//! use rpi_runtime::control::{Options, open};
//! use rpi_sim::{Cell, SimBank};
//!
//! # fn example(images: [std::sync::Arc<rpi_image::Image>; 2]) -> Result<(), Box<dyn std::error::Error>> {
//! let cell = Cell::parse("cell.toml", "")?;
//! let bank = || SimBank::new(&cell, 1e-3);
//! let (mut control, mut executive) = open(bank(), Box::new(bank()), Options::default());
//! let [first, second] = images;
//! let a = control.load(first)?;
//! let b = control.load(second)?;
//! control.schedule(Rule::follow(a).start(b))?;
//! control.start(a)?;
//! for tick in 0..1000 {
//!     executive.tick(tick * 1_000_000, &mut ());  // on a thread of its own in real time
//!     while let Some(event) = control.poll() {
//!         println!("{event:?}");
//!     }
//! }
//! # Ok(()) }
//! ```
//! This module must not depend on the source of images or requests: no files, no sockets, no sessions.

mod admission;
mod control_handle;
mod event;
mod executive;
mod export_snapshot;
mod plant;
mod queue;
mod raw;
mod request_log;
mod safe_values;
mod subscription;

pub use admission::{Budget, BudgetExceededError};
pub use control_handle::{AdoptedCommand, CommandInfo, Control};
pub use event::{Event, RequestError, Ticket};
pub use executive::{Checkpoint, Executive};
pub use export_snapshot::ExportSnapshot;
pub use plant::{AttributedOverrun, Plant};
pub use queue::{InputValue, Options, Request};
pub use raw::RawControl;
pub use request_log::{RequestLog, RequestRecord};
pub use rpi_core::{
    AbortReason, Cause, CommandError, CommandId, CommandState, Condition, Ending, Fact, Notice,
    Rule, RuleId, RuleOutcome,
};
pub use subscription::Subscription;

use rpi_device::DeviceBank;

/// Opens a control core that moves the devices of `plant`. Returns its host side and its cycle side.
///
/// `names` must resolve port names in the same way as `plant`. It is only used for name resolution; its devices never
/// move.
#[must_use]
pub fn open<P: Plant>(
    plant: P,
    names: Box<dyn DeviceBank + Send>,
    options: Options,
) -> (Control<P::Device>, Executive<P>) {
    let (cycle, host) = queue::queues(options);
    (
        Control::new(host, names, options),
        Executive::new(plant, cycle, options),
    )
}

/// Opens a control core that repeats recorded requests. The caller chooses the numbers of commands, rules and tickets,
/// and there is no admission control. Returns its host side and its cycle side.
#[must_use]
pub fn open_for_replay<P: Plant>(
    plant: P,
    options: Options,
) -> (RawControl<P::Device>, Executive<P>) {
    let (cycle, host) = queue::queues(options);
    (RawControl::new(host), Executive::new(plant, cycle, options))
}
