//! Comparison of messages with the expected ones in files beside the programs.

use crate::workspace_root;
use std::path::Path;
use std::process::Command;

/// Compares the messages about a program with the expected ones in the file `NAME.stderr` beside it. Returns a
/// description of the difference, or `None` if they are equal. If the environment variable `RPI_BLESS` is set, as by
/// `cargo xtask bless`, the file is overwritten first.
///
/// # Panics
/// Panics if `RPI_BLESS` is set and the file cannot be written.
#[must_use]
pub fn compare_with_expected(program: &Path, output: &str) -> Option<String> {
    let expected = program.with_extension("stderr");
    if std::env::var_os("RPI_BLESS").is_some() {
        std::fs::write(&expected, output).expect("tests/ui can be written");
    }
    let known = std::fs::read_to_string(&expected).unwrap_or_default();
    let name = program.display();
    (known != output).then(|| format!("{name}\n--- actual\n{output}--- expected\n{known}"))
}

/// Runs a tool on a program below `tests/ui`, and compares its standard error with the file `NAME.stderr` beside the
/// program. Returns a description of the difference, or `None` if they are equal. The tool is started in the folder
/// `tests/ui`. The function `args` adds the arguments of the tool for a program, whose path is relative to that folder.
///
/// # Panics
/// Panics if the program is not below `tests/ui`, or if the tool cannot be started.
#[must_use]
pub fn compare_tool_output(
    program: &Path,
    tool: &str,
    args: impl FnOnce(&mut Command, &Path),
) -> Option<String> {
    let root = workspace_root().join("tests/ui");
    let name = program.strip_prefix(&root).expect("it lies below tests/ui");
    let mut command = Command::new(tool);
    command.current_dir(&root).env("NO_COLOR", "1");
    args(&mut command, name);
    let output = command.output().expect("the tool starts");
    compare_with_expected(program, &String::from_utf8_lossy(&output.stderr))
}
