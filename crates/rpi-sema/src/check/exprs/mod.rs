//! Expressions: types and typed forms of each construct.

pub(crate) mod access;
pub(crate) mod apart;
pub(crate) mod bindings;
pub(crate) mod bracketed;
pub(crate) mod builtins;
pub(crate) mod case;
pub(crate) mod clocked;
pub(crate) mod compose;
pub(crate) mod expr;
pub(crate) mod guess;
pub(crate) mod indexing;
pub(crate) mod match_expr;
pub(crate) mod names;
pub(crate) mod operand_types;
pub(crate) mod ops;
pub(crate) mod proof_only;
pub(crate) mod spatial_ops;
pub(crate) mod spatial_parts;
pub(crate) mod update;
