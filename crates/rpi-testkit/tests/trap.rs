//! Tests that the trap catches forbidden allocations and allows the others.

use rpi_testkit::{alloc_allowed, no_alloc};

rpi_testkit::trap_allocations!();

#[test]
fn plain_arithmetic_passes() {
    let sum = no_alloc(|| (0..100_u64).map(std::hint::black_box).sum::<u64>());
    assert_eq!(sum, 4950);
}

#[test]
#[should_panic(expected = "allocations or releases")]
fn an_allocation_is_caught() {
    no_alloc(|| std::hint::black_box(vec![1_u8; 100]).len());
}

#[test]
#[should_panic(expected = "allocations or releases")]
fn a_release_is_caught() {
    let list = vec![1_u8; 100];
    no_alloc(move || drop(list));
}

#[test]
fn what_happens_between_cycles_may_allocate() {
    let length = no_alloc(|| alloc_allowed(|| vec![1_u8; 100].len()));
    assert_eq!(length, 100);
}
