//! Messages that stand beside the programs they are about.

use crate::workspace_root;
use std::path::Path;
use std::process::Command;

/// What is said of a program, if that is not what stands beside it in `NAME.stderr`; with `RPI_BLESS=1` it stands there
/// from then on.
///
/// # Panics
/// If `RPI_BLESS` is set and the message cannot be written.
#[must_use]
pub fn differs(program: &Path, said: &str) -> Option<String> {
    let expected = program.with_extension("stderr");
    if std::env::var_os("RPI_BLESS").is_some() {
        std::fs::write(&expected, said).expect("tests/ui can be written");
    }
    let known = std::fs::read_to_string(&expected).unwrap_or_default();
    let name = program.display();
    (known != said).then(|| format!("{name}\n--- says\n{said}--- but should say\n{known}"))
}

/// As [`differs`], for what a tool says of a program below `tests/ui`, where it is started; `args` adds the arguments
/// for the program of this name.
///
/// # Panics
/// If the program lies elsewhere, or the tool does not start.
#[must_use]
pub fn tool_differs(
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
    differs(program, &String::from_utf8_lossy(&output.stderr))
}
