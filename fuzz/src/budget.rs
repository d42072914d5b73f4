//! Budget of time and memory for one input.

use std::alloc::System;
use std::time::Duration;

use cap::Cap;
use rustix::time::{ClockId, clock_gettime};

/// Maximum CPU time for one input. CPU time is measured because wall-clock time would include other processes.
pub const CPU_BUDGET: Duration = Duration::from_secs(1);

/// Maximum memory for one input in bytes (200 MiB), in addition to the memory allocated before.
pub const MEMORY_BUDGET: usize = 200 << 20;

/// Factor on the CPU time budget in a build that is slower than the tools: one that is instrumented for a fuzzer takes
/// three to five times as long, and one with the little optimisation of tests two to three times. An input that is too slow
/// with instrumentation is run again in a release build (`rpi-fuzz-again`), which decides.
const BUILD_FACTOR: u32 = match (cfg!(feature = "counted"), cfg!(debug_assertions)) {
    (true, _) => 5,
    (false, true) => 3,
    (false, false) => 1,
};

/// Number of allocated bytes (2 GiB) at which the process is aborted at once, to protect the machine.
const HARD_MEMORY_LIMIT: usize = 2 << 30;

/// Global allocator that records the current and the highest number of allocated bytes.
#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, HARD_MEMORY_LIMIT);

/// Runs `work` within the budget of time and memory for one input. Must not be used by several threads at once, because
/// they would share one budget.
///
/// # Panics
/// Panics if `work` exceeds the budget.
pub fn run_within_budget(work: impl FnOnce()) {
    let (began, taken) = (cpu(), ALLOCATOR.allocated());
    work();
    let spent = cpu().saturating_sub(began);
    assert!(spent <= BUILD_FACTOR * CPU_BUDGET, "took {spent:?}");
    // `max_allocated` is the maximum since the process began. It exceeds this budget only if this run raised it,
    // because all earlier runs were within theirs.
    let most = ALLOCATOR.max_allocated().saturating_sub(taken);
    assert!(most <= MEMORY_BUDGET, "took {} MB", most >> 20);
}

fn cpu() -> Duration {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    Duration::try_from(now).unwrap_or_default()
}
