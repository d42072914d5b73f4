//! Calls: callees, arguments, primitives, operators as callees, iterators.

pub(crate) mod applied;
pub(crate) mod args;
pub(crate) mod call;
pub(crate) mod callable;
pub(crate) mod condact;
pub(crate) mod intrinsics;
pub(crate) mod iterate;
pub(crate) mod predefined_ops;
pub(crate) mod prim;
