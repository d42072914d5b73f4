//! What one input may cost.

use std::alloc::System;
use std::time::Duration;

use cap::Cap;
use rustix::time::{ClockId, clock_gettime};

/// The time that the processor may spend on one input. Other processes do not count, as wall-clock time would.
pub const CPU: Duration = Duration::from_secs(1);

/// The memory in bytes that one input may take at a time, above what is taken already.
pub const MEMORY: usize = 200 << 20;

/// What counts edges and comparisons for a fuzzer takes three to five times as long. What is slow there is run again
/// without the counting (`rpi-fuzz-again`), by which it stands or falls.
const COUNTING: u32 = if cfg!(feature = "counted") { 5 } else { 1 };

/// Memory beyond which the process ends at once, for the sake of the machine.
const HARD: usize = 2 << 30;

/// Counts what is allocated, and the most that ever was.
#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, HARD);

/// Does something with an input. Not for several threads at a time: they would share one budget.
///
/// # Panics
/// If it costs more than an input may.
pub fn within(work: impl FnOnce()) {
    let (began, taken) = (cpu(), ALLOCATOR.allocated());
    work();
    let spent = cpu().saturating_sub(began);
    assert!(spent <= COUNTING * CPU, "took {spent:?}");
    // The most so far grew in this run if it is over the budget of this run: earlier runs were within theirs.
    let most = ALLOCATOR.max_allocated().saturating_sub(taken);
    assert!(most <= MEMORY, "took {} MB", most >> 20);
}

fn cpu() -> Duration {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    Duration::try_from(now).unwrap_or_default()
}
