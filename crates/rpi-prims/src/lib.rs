//! Primitives: declarations and code.
//!
//! [`registry()`] is the table for all other crates: type checker, importer, lowering, interpreter, hover texts and
//! generated reference. A new primitive needs one declaration in a file below [`mod@catalogue`]; a new file also needs
//! one line in its `mod.rs`. A primitive has no knowledge of nets, files, clocks or other primitives.
#![no_std]

extern crate alloc;

pub mod aggregates;
pub mod c_code;
pub mod catalogue;
pub mod context;
pub mod differences;
mod dispatch;
mod fold;
pub mod geometry;
mod macros;
mod moving_sum;
pub mod operand;
pub mod registry;
mod ring_buffer;
pub mod value_types;

pub use context::{Context, CycleTime, Fault, FaultCode, FaultValues, seconds, whole_ticks};
pub use fold::fold;
pub use registry::{Prim, PrimId, RunFn, registry};
pub use rpi_device::NoDevices;
