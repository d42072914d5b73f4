//! Names, types, units, frames and presence; elaboration of a program to a net.

pub mod units;
