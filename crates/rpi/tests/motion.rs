//! Motions of arms as a user runs them: each folder of `tests/motion` holds a program, its cell and the expected ends of
//! its commands. All limits of the arms are watched.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

fn folders() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/motion");
    let entries = std::fs::read_dir(root).unwrap();
    let mut folders: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    folders.sort();
    folders
}

fn program(folder: &Path) -> PathBuf {
    let files = std::fs::read_dir(folder).unwrap();
    let mut files = files.map(|entry| entry.unwrap().path());
    let is_program = |file: &PathBuf| file.extension().is_some_and(|end| end == "rpi");
    files.find(is_program).expect("a program")
}

/// Runs a program. Returns the exit status and the outcome.
fn run(program: &Path, command: Option<&str>) -> (i32, Value) {
    let output = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .arg("run")
        .arg(program)
        .arg("--json")
        .args(command.iter().flat_map(|name| ["--command", name]))
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    let outcome = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{}: {error}: {message}", program.display()));
    (output.status.code().unwrap(), outcome)
}

fn strings<'a>(values: impl IntoIterator<Item = &'a Value>) -> Vec<&'a str> {
    let texts = values.into_iter().map(|value| value.as_str().unwrap_or(""));
    texts.collect()
}

fn elements(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn assert_run(program: &Path, expected: &Value) {
    let (status, outcome) = run(program, expected["command"].as_str());
    let place = format!("{}: {outcome:#}", program.display());
    let commands = elements(&outcome["commands"]).iter();
    let ends = strings(commands.map(|command| &command["end"]["name"]));
    assert_eq!(ends, strings(elements(&expected["ends"])), "{place}");
    let devices = elements(&outcome["devices"]);
    let errors = devices
        .iter()
        .flat_map(|device| elements(&device["troubles"]));
    let errors = strings(errors.map(|error| &error["what"]));
    assert_eq!(errors, strings(elements(&expected["errors"])), "{place}");
    assert!(
        devices.iter().all(|device| device["moving"] == false),
        "{place}"
    );
    assert_eq!(
        Some(i64::from(status)),
        expected["status"].as_i64(),
        "{place}"
    );
}

#[test]
fn motions_end_as_expected() {
    for folder in folders() {
        let text = std::fs::read_to_string(folder.join("expected.json")).unwrap();
        let expected: Value = serde_json::from_str(&text).unwrap();
        let program = program(&folder);
        elements(&expected)
            .iter()
            .for_each(|run| assert_run(&program, run));
    }
}
