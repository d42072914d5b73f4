//! Processes: one for a test alone, since what it shows ends the process; what this one holds.

use std::process::{Command, Output};

/// Starts this test program again for one test alone, with `variable` set to `case`.
///
/// # Panics
///
/// When the program cannot be started.
pub fn own_process(test: &str, variable: &str, case: &str) -> Output {
    let program = std::env::current_exe().expect("the path of this test program");
    Command::new(program)
        .args([test, "--exact", "--nocapture", "--test-threads=1"])
        .env(variable, case)
        .output()
        .expect("a process for one test")
}

/// Memory that the system holds for this process, kB: `VmRSS:` now, `VmHWM:` at its highest; 0 where it does not tell.
#[must_use]
pub fn resident(figure: &str) -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(figure));
    let number = line.and_then(|line| line.split_whitespace().next());
    number.and_then(|n| n.parse().ok()).unwrap_or(0)
}
