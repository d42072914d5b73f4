//! Runs of programs with their cells, and the ends of commands and errors of devices that are expected of them, as JSON.
//!
//! An expected run has `status` (exit status), `ends` (results of the commands, in order) and `errors` (errors of the devices),
//! and optionally `command` (name of the task), `time` (length of the run), and `cell` and `program` (pairs of texts: the second one
//! replaces the first one in the cell description or the program).

use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// Runs a program. Returns the exit status and the outcome.
fn run(program: &Path, expected: &Value) -> (i32, Value) {
    let folder = tempfile::tempdir().unwrap();
    let cell = folder.path().join("cell.toml");
    write_changed(
        &program.with_file_name("cell.toml"),
        &expected["cell"],
        &cell,
    );
    let changed = folder.path().join("changed.rpi");
    let program = match &expected["program"] {
        Value::Null => program,
        changes => {
            write_changed(program, changes, &changed);
            &changed
        }
    };
    let option = |key: &str| {
        let value = expected[key].as_str().map(str::to_owned);
        value.map_or(Vec::new(), |value| vec![format!("--{key}"), value])
    };
    let output = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .arg("run")
        .arg(program)
        .arg("--cell")
        .arg(&cell)
        .arg("--json")
        .args(option("command"))
        .args(option("time"))
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    let outcome = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{}: {error}: {message}", program.display()));
    (output.status.code().unwrap(), outcome)
}

/// Writes the text of the file `from` to the file `to` with changes: each pair of texts replaces the first one by the second.
fn write_changed(from: &Path, changes: &Value, to: &Path) {
    let mut text = std::fs::read_to_string(from).unwrap();
    for change in elements(changes) {
        let [old, new] = [0, 1].map(|k| change[k].as_str().expect("a pair of texts"));
        assert!(text.contains(old), "{}: no {old} in it", from.display());
        text = text.replace(old, new);
    }
    std::fs::write(to, text).unwrap();
}

fn strings<'a>(values: impl IntoIterator<Item = &'a Value>) -> Vec<&'a str> {
    let texts = values.into_iter().map(|value| value.as_str().unwrap_or(""));
    texts.collect()
}

pub(crate) fn elements(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// Runs a program and compares the run with the expected one. Returns the outcome.
pub(crate) fn assert_run(program: &Path, expected: &Value) -> Value {
    let (status, outcome) = run(program, expected);
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
    outcome
}

/// Reads the list of expected runs in a file.
pub(crate) fn expected_runs(file: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", file.display()))
}
