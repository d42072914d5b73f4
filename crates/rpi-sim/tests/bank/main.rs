//! The devices of a cell through the interface of the core: names, resource numbers, functions, determinism, and no
//! allocation in a tick.

mod cell;
mod determinism;
mod ports;
mod terminals;
mod tool;

rpi_testkit::trap_allocations!();
