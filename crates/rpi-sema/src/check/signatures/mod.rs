//! Signatures of callables: ports, static parameters, instances, generic declarations.

pub(crate) mod alias;
pub(crate) mod callable_args;
pub(crate) mod constraint;
pub(crate) mod external;
pub(crate) mod generic;
pub(crate) mod header;
pub(crate) mod imported;
pub(crate) mod instance;
pub(crate) mod sample_check;
pub(crate) mod size_inference;
pub(crate) mod static_args;
pub(crate) mod static_params;
pub(crate) mod unit;
pub(crate) mod units_on_demand;
