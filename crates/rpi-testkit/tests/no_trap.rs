//! A test binary without the trap cannot pass by accident.

#[test]
#[should_panic(expected = "trap_allocations")]
fn a_missing_trap_is_reported() {
    rpi_testkit::no_alloc(|| ());
}
