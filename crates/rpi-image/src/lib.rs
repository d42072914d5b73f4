//! Plain data of the flat image: value types, primitive descriptors, the image format and its verifier.
//!
//! This crate is the interface between the compiler and the real-time core. Both depend on it; it depends on neither.
//! It has no knowledge of files, clocks, device drivers or source text.
#![no_std]

extern crate alloc;

pub mod claim;
pub mod desc;
pub mod hash;
pub mod image;
pub mod operands;
pub mod plan;
pub mod print;
pub mod rpib;
pub mod ty;
pub mod value;
pub mod verify;
mod wire;

pub use desc::{
    Answer, CommandFlow, Default as PortDefault, DevicePorts, DeviceUse, InPort, Need, OutPort,
    Param, ParamType, PortType, Presence, PrimDesc, Role, Shape, ShapeArgs, SizeArgs, State,
};
pub use image::{Form, Image, Step};
pub use ty::{Scalar, Type};
pub use value::{Bits, Value};
pub use verify::{Catalogue, VerifyError, verify};
pub use wire::ReadError;
