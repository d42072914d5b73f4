//! The tools as processes, in a folder with a cell of one arm.

use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use super::output_text;

/// Cell of one light-weight arm, called `arm`, at its home position.
pub(crate) const CELL: &str =
    "[devices.arm]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\njoints = \"home\"\n";

/// Runs a tool in a folder with this standard input.
pub(crate) fn run(program: &str, arguments: &[&str], folder: &Path, input: &str) -> Output {
    let tool = match program {
        "rpi" => env!("CARGO_BIN_EXE_rpi").into(),
        _ => Path::new(env!("CARGO_BIN_EXE_rpi")).with_file_name(program),
    };
    let mut command = Command::new(tool);
    command
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::piped());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the tool starts");
    let mut keys = child.stdin.take().expect("a pipe");
    // A tool that ends early reads no keys.
    let _ = keys.write_all(input.as_bytes());
    drop(keys);
    child.wait_with_output().expect("the tool ends")
}

/// Runs `program.rpi` of a folder to its end with a recording. Returns what the tool has printed, and the rows.
pub(crate) fn run_recorded(folder: &Path) -> (String, String) {
    let arguments = ["run", "program.rpi", "--record", "out.csv"];
    let done = run("rpi", &arguments, folder, "");
    let text = output_text(&done);
    assert_eq!(done.status.code(), Some(0), "{text}");
    let rows = std::fs::read_to_string(folder.join("out.csv")).expect("recorded");
    (text, rows)
}

/// Returns a folder with the cell, and the files with these texts.
pub(crate) fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in [("cell.toml", CELL)].iter().chain(files) {
        std::fs::write(folder.path().join(name), text).expect("written");
    }
    folder
}
