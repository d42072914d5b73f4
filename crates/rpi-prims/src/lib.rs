//! Every primitive, each declared in one place.
//!
//! [`registry()`] is what everybody else reads: the type checker, the importer, the lowering, the interpreter, hover
//! texts and the generated reference. Adding a primitive is one declaration in a file below [`mod@catalogue`] and, for a
//! new file, one line in its `mod.rs`. A primitive must not know a net, a file, a clock or another primitive.
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
