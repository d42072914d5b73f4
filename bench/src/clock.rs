//! Clocks of the measurements: processor time instead of wall-clock time.
//!
//! Other programs on the machine do not affect processor time directly. Their effects on caches and on the clock rate
//! remain, so the best of several tries counts.

use rustix::time::{ClockId, clock_gettime};

/// Returns the processor time of the calling thread since its start, in nanoseconds.
#[must_use]
pub fn thread_ns() -> f64 {
    let t = clock_gettime(ClockId::ThreadCPUTime);
    t.tv_sec as f64 * 1e9 + t.tv_nsec as f64
}

/// Returns the processor time of all threads of this process since its start, in nanoseconds.
#[must_use]
pub fn process_ns() -> f64 {
    let t = clock_gettime(ClockId::ProcessCPUTime);
    t.tv_sec as f64 * 1e9 + t.tv_nsec as f64
}

/// Calls `run`. Returns its result and the processor time of this thread for the call, in nanoseconds.
pub fn timed<T>(run: impl FnOnce() -> T) -> (T, f64) {
    let start = thread_ns();
    let result = run();
    (result, thread_ns() - start)
}
