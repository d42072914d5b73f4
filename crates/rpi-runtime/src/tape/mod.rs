//! Tape: a log of the exchange between core and devices in each tick, and of the flows that the commands computed.
//!
//! With a tape in place of the devices, a replay of the core is bit-exact, whatever the devices were. A tape is a
//! sequence of ticks. A tick is a header and two lists of entries:
//!
//! ```text
//! tick    = lost, number, clock, kind, n, m, n words of device exchange, m words of observations
//!           lost: number of ticks dropped before this one; clock: ns since the Unix epoch;
//!           kind: 0 for a tick, 1 for entries between two ticks without a tick after them
//! entry   = head, words
//! head    = kind << 56 | flag << 55 | number of words << 32 | key
//! ```
//! [`Kind`] documents the kinds, flags and keys. This module must not depend on the file format of recordings.

mod entry;
mod player;
mod reason;
mod ring;
mod stage;
mod taped;

pub use entry::{Entry, Kind, entries};
pub use player::{Mismatch, Player, late_of};
pub use reason::{number_of, why_of};
pub use ring::{TapeIn, TapeOut, Tick, tape};
pub use stage::Stage;
pub use taped::Taped;
