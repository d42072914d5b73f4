//! The allocation trap: a test that runs a net fails if the cycle allocates or frees.
//!
//! A test binary installs the trap once with [`trap_allocations!`](crate::trap_allocations) and wraps
//! what must not allocate in [`no_alloc`].

use std::sync::OnceLock;

pub use assert_no_alloc::AllocDisabler;

/// The system's allocator, trapped and counted: `allocated()` tells how many bytes are held.
pub type Memory = cap::Cap<AllocDisabler>;

/// Installs the allocator that [`no_alloc`] watches as `MEMORY`. Once per test binary, at the top level.
#[macro_export]
macro_rules! trap_allocations {
    () => {
        #[global_allocator]
        static MEMORY: $crate::Memory = $crate::Memory::new($crate::AllocDisabler, usize::MAX);
    };
}

/// Runs `body` on this thread with every allocation and release forbidden.
///
/// # Panics
///
/// If `body` allocated or freed, with the count; and if the trap is not installed, so that a test
/// cannot pass because it forgot [`trap_allocations!`](crate::trap_allocations).
pub fn no_alloc<T>(body: impl FnOnce() -> T) -> T {
    assert!(
        is_installed(),
        "rpi_testkit::trap_allocations!() is missing in this test binary"
    );
    let (result, count) = counted(body);
    assert_eq!(
        count, 0,
        "{count} allocations or releases where none may happen"
    );
    result
}

/// Runs `body` with allocations allowed again, inside of [`no_alloc`]: for what a test does between
/// cycles.
pub fn alloc_allowed<T>(body: impl FnOnce() -> T) -> T {
    assert_no_alloc::permit_alloc(body)
}

/// Tries it out, once per test binary, with an allocation that the trap would count.
fn is_installed() -> bool {
    static INSTALLED: OnceLock<bool> = OnceLock::new();
    *INSTALLED.get_or_init(|| counted(|| drop(std::hint::black_box(Box::new(0_u8)))).1 > 0)
}

fn counted<T>(body: impl FnOnce() -> T) -> (T, u32) {
    let before = assert_no_alloc::violation_count();
    let result = assert_no_alloc::assert_no_alloc(body);
    (result, assert_no_alloc::violation_count() - before)
}
