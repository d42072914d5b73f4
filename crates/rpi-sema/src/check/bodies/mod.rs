//! Bodies of callables: their flows, equations, contracts and automata.

pub(crate) mod assumptions;
pub(crate) mod automaton;
pub(crate) mod blocks;
pub(crate) mod body;
pub(crate) mod contract;
pub(crate) mod defaults;
pub(crate) mod definitions;
pub(crate) mod elements;
pub(crate) mod inference_errors;
pub(crate) mod locals;
pub(crate) mod none_type;
pub(crate) mod statement;
pub(crate) mod targets;
pub(crate) mod tuple_pieces;
pub(crate) mod type_inference;
