//! Tape: a log of the exchange between core and devices in each tick, and of the flows that the commands computed.
//!
//! With a tick log in place of the devices, a replay of the core is bit-exact, whatever the devices were. A tick log is a
//! sequence of ticks. A tick is a header and two lists of entries:
//!
//! ```text
//! tick    = lost, number, clock, kind, n, m, n words of device exchange, m words of observations
//!           lost: number of ticks dropped before this one; clock: ns since the Unix epoch;
//!           kind: 0 for a tick, 1 for entries between two ticks without a tick after them
//! entry   = head, words
//! head    = kind << 56 | flag << 55 | number of words << 32 | key
//! ```
//! [`EntryKind`] documents the kinds, flags and keys. This module must not depend on the file format of recordings.

mod entry;
mod entry_buffer;
mod logging_bank;
mod reason;
mod replay_bank;
mod ring;

pub use entry::{EntryKind, LogEntry, decode_entries};
pub use entry_buffer::EntryBuffer;
pub use logging_bank::LoggingBank;
pub use reason::{reason_from_number, reason_number};
pub use replay_bank::{Mismatch, ReplayBank, decode_overrun};
pub use ring::{LoggedTick, TickLogReader, TickLogWriter, tick_log};
