//! Primitives of the language beyond those of the reference system, in the namespace `Rpi`.

pub(super) mod commands;
mod devices;
pub(super) mod guarded;
pub(super) mod int;
pub(super) mod logic;
pub(super) mod machine;
pub(super) mod profile;
pub(super) mod reach;
pub(super) mod real;
pub(super) mod spatial;
pub(super) mod ticks;
pub(super) mod typed;
