//! Diagnostics of `rpi run` for a node with a fault in its cycles: `tests/ui/running/NAME.rpi` on `NAME.csv` gives
//! `NAME.stderr`. `cargo xtask bless ui` updates the files.

use std::path::Path;

use rpi_testkit::{compare_tool_output, files_below};

#[test]
fn runs_say_what_stands_beside_them() {
    let programs = files_below("tests/ui/running", &[".rpi", ".lus"]);
    assert!(!programs.is_empty(), "no programs in tests/ui/running");
    let wrong: Vec<String> = programs.iter().filter_map(|path| differs(path)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Returns the output for a program if it differs from the expected one.
fn differs(path: &Path) -> Option<String> {
    compare_tool_output(path, env!("CARGO_BIN_EXE_rpi"), |command, name| {
        command.arg("run").arg(name).arg("--inputs");
        command.arg(path.with_extension("csv"));
    })
}
