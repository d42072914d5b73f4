//! The tool as a process, for tests of its runs.

use std::process::{Command, Output};

/// Runs the tool with these arguments, without colours.
pub(crate) fn rpi(arguments: &[&str]) -> Output {
    let mut rpi = Command::new(env!("CARGO_BIN_EXE_rpi"));
    rpi.args(arguments).env("NO_COLOR", "1").output().unwrap()
}

/// Returns everything that the tool has printed.
pub(crate) fn printed(output: &Output) -> String {
    let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    format!("{out}{err}")
}
