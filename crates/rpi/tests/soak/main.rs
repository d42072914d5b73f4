//! Random takeovers, cancels, aborts, emergency stops and device faults on two simulated arms, through the interface
//! that programs use. Checks that there is no cycle between two commands, that set-points are within the limits of the
//! arms in every cycle, also while an arm brakes on its own, that nothing leaks and that no cycle allocates.
//!
//! `RPI_TAKEOVERS` sets the number of takeovers; `cargo xtask soak` runs a million.

mod cell;
mod limit_check;
mod random_requests;

use random_requests::RandomDriver;
use rpi_testkit::resident_memory_kb;

rpi_testkit::trap_allocations!();

const TAKEOVERS: u64 = 10_000;

#[test]
fn arms_are_never_let_go_of() {
    let wanted = std::env::var("RPI_TAKEOVERS").map_or(TAKEOVERS, |n| n.parse().expect("a number"));
    let mut life = RandomDriver::new(wanted);
    let early = wanted / 10;
    life.run_until(early);
    let settled = resident_memory_kb("VmRSS:");
    life.run_until(wanted);
    let grown = resident_memory_kb("VmRSS:").saturating_sub(settled);
    println!("{life}, {grown} kB more than after {early}");
    life.come_to_rest();
    life.is_eventful();
    assert!(grown < 4096, "{grown} kB of memory were not given back");
}
