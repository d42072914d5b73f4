//! Expected output of the tools for programs without errors: `tests/ui/testing` with `rpic test`, `tests/ui/emitting`
//! with `rpic compile --emit`. The expected messages are in a file beside each program; `cargo xtask bless ui` overwrites them.

use std::path::Path;

use rpi_testkit::{compare_tool_output, files_below};

#[test]
fn tests_say_what_stands_beside_them() {
    compare("testing", &["test"], ".rpi");
}

#[test]
fn forms_that_leave_something_out_say_so() {
    compare("emitting", &["compile", "--emit", "rpinet"], ".rpi");
    compare("emitting_lustre", &["compile", "--emit", "lustre"], ".rpi");
}

fn compare(folder: &str, task: &[&str], ending: &str) {
    let programs = files_below(&format!("tests/ui/{folder}"), &[ending]);
    assert!(!programs.is_empty(), "no programs in tests/ui/{folder}");
    let wrong: Vec<String> = programs
        .iter()
        .filter_map(|path| differs(path, task))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Compares the messages about a program with the expected ones.
fn differs(path: &Path, task: &[&str]) -> Option<String> {
    compare_tool_output(path, env!("CARGO_BIN_EXE_rpic"), |command, name| {
        command.args(task).arg(name);
    })
}
