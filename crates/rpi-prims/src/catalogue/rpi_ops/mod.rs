//! Primitives of the language beyond those of the reference system, in the namespace `Rpi`.

pub(super) mod commands;
mod devices;
pub(super) mod external;
pub(super) mod guarded;
pub(super) mod int;
pub(super) mod logic;
pub(super) mod machine_int;
pub(super) mod motion;
pub(super) mod path_event;
pub(super) mod per_type;
pub(super) mod real;
pub(super) mod spatial;
pub(super) mod ticks;
