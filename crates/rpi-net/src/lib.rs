//! Dataflow nets: primitives joined by typed links in a tree of fragments, and the passes that check them.
//!
//! Both front ends produce a [`Net`]: `.rpi` programs are elaborated to one, `.rpinet` files are parsed as one. The
//! later stages (lowering, execution) accept only nets that have passed [`passes`]. A net does not depend on syntax
//! trees or on the image; each node records its source as an [`Origin`].

pub mod claim;
mod column;
mod landmark;
pub mod lustre;
pub mod net;
pub mod passes;
mod prim;
pub mod rpinet;
pub mod shape;
mod solver;
pub mod tree;
mod violation;

pub use claim::{Claim, ClaimKind, ClaimRead};
pub use column::Column;
pub use landmark::{Choice, Exit, Exits, Landmarks, Side};
pub use net::{
    Absent, Activation, Alternatives, Driver, ExportPort, Fragment, FragmentId, FragmentPort,
    Given, Input, Inputs, Net, Node, NodeId, Origin, PortRef, Restart, ResultKind, ResultPort,
    Types, without_calls,
};
pub use rpi_prims::PrimId;
pub use tree::{Item, Tree};
pub use violation::Violation;
