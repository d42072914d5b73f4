//! The paper's example as a reader runs it: both traces of Fig. 5, without a gap and without a jump.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Bounds on joint velocity and acceleration in the example, rad/s and rad/s².
const SPEED: f64 = 3.15;
const ACCELERATION: f64 = 4.0;
/// Period of the example in s.
const DT: f64 = 1e-3;

/// Runs the example. Returns the summary, and the commanded positions of each joint by cycle.
fn run(options: &[&str]) -> (String, BTreeMap<String, Vec<f64>>) {
    let example =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/blending/blending.rpi");
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("record.csv");
    let output = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .arg("run")
        .arg(example)
        .arg("--record")
        .arg(&record)
        .args(options)
        .env("NO_COLOR", "1")
        .output()
        .unwrap();
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    (
        text.into_owned(),
        joints(&std::fs::read_to_string(record).unwrap()),
    )
}

/// Returns the joint rows of a recording; each joint must have one row per cycle, from 0 on.
fn joints(record: &str) -> BTreeMap<String, Vec<f64>> {
    let mut joints: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for row in record.lines().filter(|row| row.contains(",arm.joint.")) {
        let parts: Vec<&str> = row.split(',').collect();
        let rows = joints.entry(parts[1].to_owned()).or_default();
        assert_eq!(
            parts[0].parse(),
            Ok(rows.len()),
            "a cycle is missing or doubled: {row}"
        );
        rows.push(parts[2].parse().unwrap());
    }
    joints
}

fn differences(values: &[f64]) -> Vec<f64> {
    values
        .windows(2)
        .map(|pair| (pair[1] - pair[0]) / DT)
        .collect()
}

fn assert_continuous(joints: &BTreeMap<String, Vec<f64>>) {
    assert_eq!(joints.len(), 7);
    for (joint, positions) in joints {
        let speeds = differences(positions);
        let accelerations = differences(&speeds);
        assert!(speeds.iter().all(|v| v.abs() < SPEED), "{joint} jumps");
        assert!(
            accelerations.iter().all(|a| a.abs() < ACCELERATION),
            "{joint} changes its speed at once"
        );
    }
}

fn ends(text: &str, what: &str) -> usize {
    text.lines()
        .filter(|line| line.starts_with("MoveToC") && line.contains(what))
        .count()
}

#[test]
fn a_successor_in_time_takes_over_at_b() {
    let (text, joints) = run(&[]);
    assert_eq!(ends(&text, "taken over at at_b"), 9, "{text}");
    assert_continuous(&joints);
}

/// Rule M11.5.
#[test]
fn a_successor_too_late_follows_the_regular_end_at_c() {
    let (text, joints) = run(&["--planning-time", "20s"]);
    assert_eq!(ends(&text, "finished with at_c"), 9, "{text}");
    assert_continuous(&joints);
}
