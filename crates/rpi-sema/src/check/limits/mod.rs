//! Limits on nesting and size, and infinite recursion.

pub(crate) mod nesting;
pub(crate) mod recursion;
