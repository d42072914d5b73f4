//! The tape: all that passed between the core and its devices in a tick, and what the commands computed, as numbers in
//! the order in which it happened.
//!
//! With a tape in place of the devices the core does again what it has done, bit for bit, whatever the devices were. A tape is a
//! row of ticks, a tick is a header and two rows of entries:
//!
//! ```text
//! tick    = lost, number, clock, kind, n, m, n words of exchange, m words of sights
//!           lost: ticks before this one for which there was no room; clock: ns since the Unix epoch;
//!           kind: 0 for a tick, 1 for what happened between two without a tick after it
//! entry   = head, words
//! head    = kind << 56 | flag << 55 | number of words << 32 | key
//! ```
//! What the kinds, flags and keys mean stands in the table of [`Kind`]. This module must not know what a recording is written to.

mod entry;
mod player;
mod ring;
mod stage;
mod taped;

pub(crate) use entry::{Entry, Kind, entries};
pub(crate) use player::{Mismatch, Player, late_of};
pub(crate) use ring::{TapeIn, TapeOut, Tick, tape};
pub(crate) use stage::Stage;
pub use taped::Taped;
