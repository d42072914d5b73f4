//! `rpi debug` in a terminal: for each program `tests/debug/NAME.rpi`, `NAME.txt` holds the lines of a user, behind `(rpi) `, and what
//! the debugger answers. `RPI_BLESS=1` writes the answers.

mod support;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What the debugger writes before each line of the user.
const PROMPT: &str = "(rpi) ";

fn programs() -> Vec<PathBuf> {
    let folder = rpi_testkit::workspace_root().join("tests/debug");
    let files = std::fs::read_dir(folder).unwrap();
    let files = files.map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = files
        .filter(|file| file.extension().is_some_and(|end| end == "rpi"))
        .collect();
    files.sort();
    files
}

/// Debugs a program with these lines, and returns what the debugger writes.
fn debug(program: &Path, lines: &str) -> String {
    let mut debugger = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .arg("debug")
        .arg(program)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = debugger.stdin.take().unwrap();
    input.write_all(lines.as_bytes()).unwrap();
    drop(input);
    let output = debugger.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", program.display());
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_transcript_is_what_the_debugger_answers() {
    let programs = programs();
    assert!(programs.len() >= 2);
    for program in programs {
        let file = program.with_extension("txt");
        let expected = std::fs::read_to_string(&file).unwrap();
        let lines = expected
            .lines()
            .filter_map(|line| line.strip_prefix(PROMPT));
        let lines: String = lines.map(|line| format!("{line}\n")).collect();
        let found = debug(&program, &lines);
        if std::env::var_os("RPI_BLESS").is_some() {
            std::fs::write(&file, &found).unwrap();
        } else {
            assert_eq!(found, expected, "{}", program.display());
        }
    }
}
