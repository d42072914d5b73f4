//! A test that needs a process of its own, since what it shows ends the process.

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
