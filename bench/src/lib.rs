//! Nets to measure and to test with: a builder, generators of regular and irregular nets, and a cell that has every
//! device.
//!
//! Only tests and benches depend on this crate.

pub mod build;
pub mod clock;
pub mod generate;
pub mod puppet;
pub mod rng;
pub mod twin;
pub mod yardstick;

pub use build::Build;
pub use puppet::Puppet;
