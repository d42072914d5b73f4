//! Nets and programs for benchmarks and tests: a net builder, generators of regular and irregular nets and of programs
//! of all shapes, and a device bank that has every device.
//!
//! Only tests and benchmarks depend on this crate.

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
