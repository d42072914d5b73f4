//! Calls: callees, arguments, primitives, operators as callees, iterators.

pub(crate) mod applied;
pub(crate) mod arg_tuples;
pub(crate) mod args;
pub(crate) mod call;
pub(crate) mod callable;
pub(crate) mod callee;
pub(crate) mod condact;
pub(crate) mod frame_binding;
pub(crate) mod intrinsics;
pub(crate) mod iterate;
pub(crate) mod predefined_ops;
pub(crate) mod prim;
pub(crate) mod prim_ports;
