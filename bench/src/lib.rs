//! Nets and programs for benchmarks and tests: a net builder, generators of regular and irregular nets and of programs
//! of all shapes, and a device bank that has every device.
//!
//! Only tests and benchmarks depend on this crate.

mod bench_error;
pub mod clock;
pub mod fake_devices;
pub mod flat_c;
pub mod gcc_reference;
pub mod generate;
pub mod image_compare;
pub mod net_builder;
pub mod program;
pub mod rng;
pub mod table;

pub use bench_error::BenchError;
pub use fake_devices::FakeDevices;
pub use net_builder::NetBuilder;
