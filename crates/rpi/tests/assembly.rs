//! The assembly example as a reader runs it: the measured force selects the next command, and the arm is under control
//! in every case.

use std::path::Path;
use std::process::Command;

/// Runs the example with a changed cell. Returns the outcome, and the measured force by cycle of the pressing command.
fn run(change: impl Fn(&str) -> String) -> (serde_json::Value, Vec<f64>) {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/assembly");
    let folder = tempfile::tempdir().unwrap();
    let [cell, record] = ["cell.toml", "record.csv"].map(|name| folder.path().join(name));
    let text = std::fs::read_to_string(example.join("cell.toml")).unwrap();
    std::fs::write(&cell, change(&text)).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .args([
            "run",
            example.join("assembly.rpi").to_str().unwrap(),
            "--json",
        ])
        .args([
            "--cell",
            cell.to_str().unwrap(),
            "--record",
            record.to_str().unwrap(),
        ])
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    let outcome =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {stderr}"));
    let record = std::fs::read_to_string(record).unwrap();
    let felt = record
        .lines()
        .filter_map(|row| row.split_once(",Press.felt,"));
    (
        outcome,
        felt.map(|(_, value)| value.parse().unwrap()).collect(),
    )
}

/// Returns the names of the commands that ran, with their results.
fn story(outcome: &serde_json::Value) -> Vec<(String, String)> {
    let text = |value: &serde_json::Value| value.as_str().unwrap_or("").to_owned();
    let commands = outcome["commands"].as_array().unwrap();
    let endings = commands
        .iter()
        .map(|c| (text(&c["name"]), text(&c["end"]["name"])));
    endings.collect()
}

fn assert_story(outcome: &serde_json::Value, expected: &[(&str, &str)]) {
    let story = story(outcome);
    let story: Vec<_> = story
        .iter()
        .map(|(a, b)| (a.as_str(), b.as_str()))
        .collect();
    assert_eq!(story, expected, "{outcome:#}");
}

fn assert_safe(outcome: &serde_json::Value) {
    let arm = &outcome["devices"][0];
    assert_eq!(arm["moving"], false, "{outcome:#}");
    assert_eq!(
        arm["troubles"].as_array().map(Vec::len),
        Some(0),
        "{outcome:#}"
    );
}

/// Row 20 of the paper's promises: contact is detected, the motion is taken over, the requested force is applied, and
/// the arm retracts.
#[test]
fn what_is_felt_decides_what_follows() {
    let (outcome, felt) = run(str::to_owned);
    let expected = [
        ("Approach", "there"),
        ("Search", "touched"),
        ("Press", "pressed"),
        ("Leave", "away"),
    ];
    assert_story(&outcome, &expected);
    assert_safe(&outcome);
    let last = felt.last().copied().unwrap();
    assert!((last - 10.0).abs() < 0.5, "{last} N at the end");
    let most = felt.iter().copied().fold(0.0, f64::max);
    assert!(most < 12.0, "{most} N on the way");
}

#[test]
fn where_nothing_is_felt_it_goes_back() {
    let (outcome, felt) = run(|cell| cell.replace("350 mm", "300 mm"));
    let expected = [
        ("Approach", "there"),
        ("Search", "missed"),
        ("Leave", "away"),
    ];
    assert_story(&outcome, &expected);
    assert_safe(&outcome);
    assert!(felt.is_empty());
}

/// An unforeseen event: a blow during the downward motion.
#[test]
fn a_blow_ends_it_with_an_error_and_the_arm_stops_itself() {
    let blow = "\n[[devices.arm.faults]]\nat = \"1.5 s\"\ntrouble = \"contact\"\nforce = [0, 0, \"40 N\"]\n";
    let (outcome, _) = run(|cell| format!("{}{blow}", cell.replace("350 mm", "300 mm")));
    assert_story(&outcome, &[("Approach", "there"), ("Search", "bumped")]);
    assert_safe(&outcome);
}
