//! Online trajectory generator: properties of random motions, and durations of published cases.
//!
//! The environment variable `RPI_ONLINE` sets the number of random motions. `bench/online` compares with `ruckig`.

mod cases;
mod published;
mod random;
mod requests;
mod verify;

rpi_testkit::trap_allocations!();
