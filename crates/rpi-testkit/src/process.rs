//! Processes: a separate process for one test that ends its process, and the memory of the current process.

use std::process::{Command, Output};

/// Runs the one test `test` of this test program in a new process, with the environment variable `variable` set to
/// `case`. Returns the exit status and the output of the process.
///
/// # Panics
///
/// Panics if the program cannot be started.
pub fn run_test_in_process(test: &str, variable: &str, case: &str) -> Output {
    let program = std::env::current_exe().expect("the path of this test program");
    Command::new(program)
        // `--exact`, because the name of a test may be part of another one; `--nocapture`, because the caller reads the
        // output.
        .args([test, "--exact", "--nocapture", "--test-threads=1"])
        .env(variable, case)
        .output()
        .expect("a process for one test")
}

/// Returns a memory figure of this process in kB: `VmRSS:` selects the current resident memory, `VmHWM:` its maximum.
/// Returns 0 on systems without `/proc`.
#[must_use]
pub fn resident_memory_kb(figure: &str) -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(figure));
    let number = line.and_then(|line| line.split_whitespace().next());
    number.and_then(|n| n.parse().ok()).unwrap_or(0)
}
