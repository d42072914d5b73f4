//! Names, types, units, frames and presence; elaboration of a program to a net.
//!
//! The course of a program through this crate:
//!
//! 1. [`program`]: the table of declarations, by module and name;
//! 2. [`check()`]: every callable becomes a [`typed::Unit`];
//! 3. [`facts`]: by which clock flows tick ([`clocks`]), and which can be absent;
//! 4. [`elab`]: a unit that is run becomes an [`rpi_net::Net`];
//! 5. [`init`]: nothing in the net is read before it has a value.
//!
//! Beside it, [`query`] says what stands where, for editors.
//!
//! This crate must not know files, memory layout or devices.

mod check;
pub mod clocks;
pub mod elab;
pub mod facts;
mod hash;
pub mod init;
mod needless;
pub mod program;
pub mod query;
mod sound;
mod told;
pub mod ty;
pub mod typed;
pub mod units;

pub use check::{Checked, check, no_file, result_identity};
pub use needless::needless;
pub use sound::{sound, without_lacks_of_open_bodies};
pub use told::told;
