//! Allocation trap: a test that runs a net fails if a cycle allocates or frees memory.
//!
//! A test binary installs the trap once with [`trap_allocations!`](crate::trap_allocations) and wraps the code that
//! must not allocate in [`no_alloc`].

use std::sync::OnceLock;

pub use assert_no_alloc::AllocDisabler;

/// Global allocator for tests. It records allocations in code that must not allocate ([`no_alloc`]), and counts the
/// allocated bytes (`allocated()`).
pub type TrappedAllocator = cap::Cap<AllocDisabler>;

/// Installs [`TrappedAllocator`], which [`no_alloc`] needs, as the global allocator `MEMORY`. Use the macro once in a
/// test binary, at the top level.
#[macro_export]
macro_rules! trap_allocations {
    () => {
        #[global_allocator]
        static MEMORY: $crate::TrappedAllocator =
            $crate::TrappedAllocator::new($crate::AllocDisabler, usize::MAX);
    };
}

/// Runs `body` on this thread and returns its result. Allocating and freeing memory is forbidden meanwhile.
///
/// # Panics
///
/// Panics if `body` allocates or frees memory; the message contains the count. Panics if
/// [`trap_allocations!`](crate::trap_allocations) is missing in the test binary, because the test would then pass
/// without a check.
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

/// Runs `body` and returns its result. Within [`no_alloc`], allocations are allowed in `body`: for work of a test
/// between two cycles.
pub fn alloc_allowed<T>(body: impl FnOnce() -> T) -> T {
    assert_no_alloc::permit_alloc(body)
}

/// Returns true if the trap for allocations is installed. The first call makes an allocation that the trap would count;
/// later calls return the same result.
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
