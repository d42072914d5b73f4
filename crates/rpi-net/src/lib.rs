//! The net: primitives joined by typed links in a tree of fragments.
//!
//! Both ways into the compiler end here: `.rpi` programs are elaborated to a [`Net`], `.rpinet` files are read as one.
//! Everything after this crate (lowering, running) sees only a net that has passed [`passes`]. A net must not know
//! syntax trees or the image; where it came from is an [`Origin`] per node and nothing more.

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
