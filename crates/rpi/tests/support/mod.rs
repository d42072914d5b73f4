//! Runs of the tool and their output.
#![allow(dead_code, reason = "each test target uses a part")]

pub(crate) mod expected_runs;
pub(crate) mod recordings;
pub(crate) mod tools;

use std::process::{Command, Output};

/// Runs the tool without colours.
pub(crate) fn rpi(arguments: &[&str]) -> Output {
    let mut rpi = Command::new(env!("CARGO_BIN_EXE_rpi"));
    rpi.args(arguments).env("NO_COLOR", "1").output().unwrap()
}

/// Runs the tool without colours. Returns the exit status, standard output and standard error.
pub(crate) fn rpi_texts(arguments: &[&str]) -> (i32, String, String) {
    let output = rpi(arguments);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let status = output.status.code().unwrap();
    (status, text(&output.stdout), text(&output.stderr))
}

/// Returns standard output, then standard error.
pub(crate) fn output_text(output: &Output) -> String {
    let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    format!("{out}{err}")
}
