//! Diagnostics that several parts of the checker report, and the words in which they report them.

pub(crate) mod argument_order;
pub(crate) mod dialect;
pub(crate) mod elsewhere;
pub(crate) mod foreign;
pub(crate) mod foreign_idioms;
pub(crate) mod number_fixes;
pub(crate) mod precedence_hints;
pub(crate) mod report;
pub(crate) mod reported;
pub(crate) mod suggest_callee;
pub(crate) mod undefined_names;
