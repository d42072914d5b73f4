//! A control core in operation: what programs outside of the cycle do with it while commands run.
//!
//! ```text
//! Control (host side, one owner)          Executive (cycle's side)
//!   load, start, schedule, cancel,  --->    takes requests, ticks the core, steps the devices
//!   abort, unload, set, subscribe   <---    events, samples, and what is over, to be freed
//! ```
//! [`open`] makes the two. They share nothing but bounded queues at which nobody waits: the executive takes a bounded number of
//! requests per tick and never allocates or frees; [`Control`] allocates, loads and frees.
//!
//! # The interface
//!
//! | wanted | call | answer |
//! |---|---|---|
//! | load an image | [`Control::load`], or [`Control::adopt`] for a command loaded elsewhere | its [`CommandId`], or every reason why not |
//! | start, cancel, abort, take off the schedule | [`Control::start`], [`cancel`](Control::cancel), [`abort`](Control::abort), [`unschedule`](Control::unschedule) | a [`Ticket`] |
//! | let it follow another, or any rule | [`Control::schedule`] with a [`Rule`] | a [`RuleId`] and a [`Ticket`] |
//! | give it back | [`Control::unload`] | a [`Ticket`], then [`Event::Freed`] |
//! | set inputs of any commands between the same two cycles | [`Control::set`] | a [`Ticket`] |
//! | see exported flows | [`Control::subscribe`], then [`Control::samples`] | samples where a value has changed |
//! | read what a command exports, now and then | [`Control::adopt_with_board`] | a [`Board`] |
//! | give or take a device | [`Control::put_device`] | a [`Ticket`] |
//! | stop everything | [`Control::emergency_stop`] | a [`Ticket`] |
//! | know what happens | [`Control::poll`] | [`Event`]s in order |
//! | look at a command | [`Control::get`] | [`Info`]: image, state, ending |
//!
//! Every ticket is answered by one [`Event::Answer`]; requests are carried out in the order in which they were made, so a
//! command can be loaded, named in a rule and started without waiting in between. [`Info::state`] follows the events: it is
//! what was last heard from the cycle. A command that is over keeps its place until it is unloaded; one that nothing can start
//! any more and that was not to be kept unloads itself, as [`Event::Freed`] tells.
//!
//! ```
//! use rpi_core::Rule;
//! use rpi_host::control::{Options, open};
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
//!     executive.tick(tick * 1_000_000, &mut ());  // on a thread of its own where time is real
//!     while let Some(event) = control.poll() {
//!         println!("{event:?}");
//!     }
//! }
//! # Ok(()) }
//! ```
//! This module must not know where images come from or who asks: no file, no socket, no session.

mod admission;
mod board;
mod event;
mod executive;
mod journal;
mod plant;
mod queue;
mod side;
mod subscription;

pub use admission::{Budget, TooMuch};
pub use board::Board;
pub use event::{Event, Rejected, Ticket};
pub use executive::Executive;
pub use journal::{Asked, Journal};
pub use plant::{Late, Plant};
pub(crate) use queue::{HostEnds, Request};
pub use queue::{Options, Setting};
pub use rpi_core::{
    Cause, CommandId, Condition, Ending, Fact, Notice, Outcome, Refused, Rule, RuleId, State, Why,
};
pub use side::{Adopted, Control, Info};
pub use subscription::Subscription;

use rpi_device::DeviceBank;

/// Opens a control core over these devices. `names` resolves the names of ports as `plant` does, and is never moved: the
/// devices themselves are with the cycle.
#[must_use]
pub fn open<P: Plant>(
    plant: P,
    names: Box<dyn DeviceBank + Send>,
    options: Options,
) -> (Control<P::Part>, Executive<P>) {
    let (cycle, host) = queue::queues(options);
    (
        Control::new(host, names, options),
        Executive::new(plant, cycle, options),
    )
}

/// Opens a control core for who makes requests as they were made before: nobody chooses names or keeps books.
pub(crate) fn open_plainly<P: Plant>(
    plant: P,
    options: Options,
) -> (HostEnds<P::Part>, Executive<P>) {
    let (cycle, host) = queue::queues(options);
    (host, Executive::new(plant, cycle, options))
}
