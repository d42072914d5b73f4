//! Allocation trap: a test that runs a net fails if a cycle allocates or frees memory.
//!
//! A test binary installs the trap once with [`trap_allocations!`](crate::trap_allocations) and wraps the code that
//! must not allocate in [`no_alloc`].

use std::sync::OnceLock;

pub use assert_no_alloc::AllocDisabler;

/// Global allocator for tests: the system allocator with a trap for allocations and a counter. `allocated()` returns
/// the number of allocated bytes.
pub type TrappedAllocator = cap::Cap<AllocDisabler>;

/// Installs the allocator that [`no_alloc`] checks, as the static `MEMORY`. Use it once per test binary, at the top
/// level.
#[macro_export]
macro_rules! trap_allocations {
    () => {
        #[global_allocator]
        static MEMORY: $crate::TrappedAllocator =
            $crate::TrappedAllocator::new($crate::AllocDisabler, usize::MAX);
    };
}

/// Runs `body` on this thread with all allocations and releases forbidden.
///
/// # Panics
///
/// If `body` allocates or frees memory; the message contains the count. Also if the trap is not installed, so that a
/// test cannot pass because it lacks [`trap_allocations!`](crate::trap_allocations).
pub fn no_alloc<T>(body: impl FnOnce() -> T) -> T {
    assert!(
        is_installed(),
        "rpi_testkit::trap_allocations!() is missing in this test binary"
    );
    let (result, count) = counted(body);
    assert_eq!(
        count, 0,
        "{count} allocations or releases in code that must not allocate"
    );
    result
}

/// Runs `body` with allocations allowed again, inside [`no_alloc`]: for the work of a test between cycles.
pub fn alloc_allowed<T>(body: impl FnOnce() -> T) -> T {
    assert_no_alloc::permit_alloc(body)
}

/// Returns whether the trap is installed, by making an allocation that it would count. The result is cached.
fn is_installed() -> bool {
    static INSTALLED: OnceLock<bool> = OnceLock::new();
    // `black_box` keeps the optimiser from removing the allocation.
    *INSTALLED.get_or_init(|| counted(|| drop(std::hint::black_box(Box::new(0_u8)))).1 > 0)
}

fn counted<T>(body: impl FnOnce() -> T) -> (T, u32) {
    let before = assert_no_alloc::violation_count();
    let result = assert_no_alloc::assert_no_alloc(body);
    (result, assert_no_alloc::violation_count() - before)
}
