//! Semantic analysis: names, types, units, frames, clocks and presence; elaboration of a program to a net.
//!
//! Passes, in order:
//!
//! 1. [`program`]: collects the table of declarations, by module and name;
//! 2. [`check()`]: type-checks every callable to a [`typed::Unit`];
//! 3. [`facts`]: infers the clocks ([`clocks`]) of flows and which flows can be absent;
//! 4. [`elab`]: elaborates a unit to be run into an [`rpi_net::Net`];
//! 5. [`init`]: checks that nothing in the net is read before it is initialised.
//!
//! In addition, [`query`] answers editors' questions about names and types at positions in the source.
//!
//! This crate must not know files, memory layout or devices.

mod check;
pub mod clocks;
pub mod elab;
pub mod facts;
mod hash;
pub mod init;
pub mod program;
pub mod query;
pub mod reuse;
mod sound;
pub(crate) mod summary;
pub mod ty;
pub mod typed;
pub mod units;
pub(crate) mod unused;

pub use crate::summary::summary;
pub use crate::unused::unused_warnings;
pub use check::{CheckedProgram, check, check_reusing, file_not_found, result_identity};
pub use sound::{sound_units, without_undefined_flows_in_unclosed_bodies};
