//! Primitives: declarations and code.
//!
//! [`registry()`] is the table for all other crates: type checker, importer, lowering, interpreter, hover texts and
//! generated reference. A new primitive needs one declaration in a file below [`mod@catalogue`]; a new file also needs
//! one line in its `mod.rs`. A primitive has no knowledge of nets, files, clocks or other primitives.
#![no_std]

extern crate alloc;

pub mod bulk;
pub mod catalogue;
pub mod cx;
pub mod differences;
pub mod flow;
mod fold;
pub mod geometry;
mod macros;
pub mod operand;
pub mod registry;
mod ring;
mod run;
pub mod travel;
mod window;

pub use cx::{Clock, Cx, Fault, FaultCode, seconds, whole_ticks};
pub use fold::fold;
pub use registry::{Prim, PrimId, RunFn, registry};
pub use rpi_device::NoDevices;
