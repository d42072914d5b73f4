//! Dataflow nets: primitives joined by typed links in a tree of fragments, and the passes that check them.
//!
//! Both front ends produce a [`Net`]: `.rpi` programs are elaborated to one, `.rpinet` files are parsed as one. The
//! later stages (lowering, execution) accept only nets that have passed [`passes`]. A net does not depend on syntax
//! trees or on the image; each node records its source as an [`Origin`].

pub mod claim;
mod column;
mod column_error;
mod coverage_points;
pub mod fragment_tree;
mod input;
pub mod lustre;
pub mod net;
pub mod passes;
mod prim;
pub mod rpinet;
pub mod shape;
mod solver;
mod verify_error;

pub use claim::{Claim, ClaimKind, ClaimRead};
pub use column::Column;
pub use column_error::ColumnError;
pub use coverage_points::{CoveragePoints, Decision, DecisionBranch, StateTransitions, Transition};
pub use fragment_tree::{FragmentTree, Item};
pub use net::{
    AbsentPolicy, Activation, Alternatives, CommandInput, ExportPort, Fragment, FragmentId,
    FragmentPort, Input, Inputs, Net, Node, NodeId, Origin, PortRef, Restart, ResultKind,
    ResultPort, Termination, Types, strip_unnamed_calls,
};
pub use rpi_prims::PrimId;
pub use verify_error::VerifyError;
