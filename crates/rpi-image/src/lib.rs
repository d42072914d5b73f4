//! Plain data of the flat image: value types, primitive descriptors, the image format and its verifier.
//!
//! This crate is the interface between the compiler and the real-time core. Both depend on it; it depends on neither.
//! It has no knowledge of files, clocks, device drivers or source text.
#![no_std]

extern crate alloc;

pub mod claim;
mod debug_info;
pub mod desc;
pub mod encoding;
pub mod external;
pub mod hash;
pub mod image;
pub mod operands;
pub mod plan;
pub mod rpib;
pub mod text;
pub mod types;
pub mod value;
pub mod verify;

pub use desc::{
    CommandFlow, DevicePortNames, DeviceResponse, DeviceUse, Fallback, InPort, OutPort, Param,
    ParamDefault as PortDefault, ParamType, PortType, Presence, PrimDesc, Role, ShapeArgs,
    ShapeRule, SizeArgs, StateSize,
};
pub use encoding::ReadError;
pub use image::{Form, Image, Step};
pub use types::{Scalar, Type};
pub use value::{SlotBits, Value};
pub use verify::{PrimLookup, VerifyError, verify};
