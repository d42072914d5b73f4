//! The clock of the measurements: what this thread has run, not what passed meanwhile.
//!
//! Other programs on the machine cost a measurement time on the wall, but none on this clock. What they do to caches and
//! to the clock rate shows; so the best of several tries counts.

use rustix::time::{ClockId, clock_gettime};

/// Nanoseconds that the calling thread has run on a processor so far.
#[must_use]
pub fn thread_ns() -> f64 {
    let t = clock_gettime(ClockId::ThreadCPUTime);
    t.tv_sec as f64 * 1e9 + t.tv_nsec as f64
}

/// Nanoseconds that this process has run on processors so far, all threads together.
#[must_use]
pub fn process_ns() -> f64 {
    let t = clock_gettime(ClockId::ProcessCPUTime);
    t.tv_sec as f64 * 1e9 + t.tv_nsec as f64
}

/// What `run` gives, and the nanoseconds that this thread ran for it.
pub fn timed<T>(run: impl FnOnce() -> T) -> (T, f64) {
    let start = thread_ns();
    let result = run();
    (result, thread_ns() - start)
}
