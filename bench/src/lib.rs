//! Nets and programs to measure and to test with: a builder, generators of regular and irregular nets and of programs of
//! all shapes, and a cell that has every device.
//!
//! Only tests and benches depend on this crate.

pub mod build;
pub mod clock;
pub mod generate;
pub mod program;
pub mod puppet;
pub mod rng;
pub mod table;
pub mod twin;
pub mod yardstick;

pub use build::Build;
pub use puppet::Puppet;
