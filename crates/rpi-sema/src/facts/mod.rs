//! Analyses of typed units whose results are stored beside the units: the clocks of flows, and which flows can be
//! absent.
//!
//! A pass is a function from units to facts and diagnostics. It must not change the units.

mod absence;
mod absence_error;
mod absence_rules;
pub(crate) mod dependents;
pub(crate) mod exclusive_fragments;
mod presence;
pub(crate) mod presence_check;
pub(crate) mod takeover;

pub(crate) use crate::facts::dependents::{Definition, Dependents};
pub(crate) use crate::facts::exclusive_fragments::literal;
pub use absence::Absence;
pub(crate) use presence::callees_first;
pub use presence::{Facts, FactsMemo, analyse, analyse_rest, analyse_reusing};
