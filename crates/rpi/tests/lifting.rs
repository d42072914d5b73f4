//! The example in which two arms lift a box, as a reader runs it: the distance of the grippers is constant in every
//! cycle, over both takeovers.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Width of the box and tolerance in m: the error of inverse kinematics, to which a box yields.
const WIDTH: f64 = 0.3;
const OFF: f64 = 1e-6;
/// Distance of the arms from the middle in m.
const BASE: f64 = 0.3;
const DT: f64 = 1e-3;

/// Positions of a tool by cycle, in the frame of the cell.
type Path3 = Vec<[f64; 3]>;

/// Runs the example. Returns the summary and the paths of both grippers.
fn run(options: &[&str]) -> (String, Path3, Path3) {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/lifting/lifting.rpi");
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("record.jsonl");
    let output = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .args(["run", example.to_str().unwrap(), "--record"])
        .arg(&record)
        .args(options)
        .env("NO_COLOR", "1")
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{text}");
    let mut tools = tools(&std::fs::read_to_string(record).unwrap());
    let mut of = |arm: &str, base: f64| {
        let path = tools.remove(arm).unwrap().into_iter();
        path.map(|[x, y, z]| [x, y + base, z]).collect::<Path3>()
    };
    let (left, right) = (of("left", BASE), of("right", -BASE));
    (text.into_owned(), left, right)
}

/// Returns the commanded tool positions of each arm, in the frame of its base.
fn tools(record: &str) -> BTreeMap<String, Path3> {
    let mut tools: BTreeMap<String, Path3> = BTreeMap::new();
    for line in record.lines() {
        let row: serde_json::Value = serde_json::from_str(line).unwrap();
        let Some(arm) = row["flow"]
            .as_str()
            .unwrap()
            .strip_suffix(".tcp.commanded_position")
        else {
            continue;
        };
        // `{pos:{x:..,y:..,z:..},rot:{..}}`: the first three numbers are the position.
        let text = row["value"].to_string();
        let numbers = text.split(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c)));
        let mut numbers = numbers.filter_map(|n| n.parse::<f64>().ok());
        let position = std::array::from_fn(|_| numbers.next().unwrap());
        tools.entry(arm.to_owned()).or_default().push(position);
    }
    tools
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f64>().sqrt()
}

/// Returns the first cycle of a command.
fn begins(text: &str, command: &str) -> usize {
    let line = text.lines().find(|line| line.starts_with(command)).unwrap();
    let seconds = line
        .split("from ")
        .nth(1)
        .unwrap()
        .split(' ')
        .next()
        .unwrap();
    (seconds.parse::<f64>().unwrap() / DT).round() as usize
}

fn assert_together(text: &str, left: &Path3, right: &Path3) {
    let lifted = begins(text, "Up");
    assert_eq!(left.len(), right.len());
    for (cycle, (l, r)) in left.iter().zip(right).enumerate().skip(lifted) {
        let off = distance(l, r) - WIDTH;
        assert!(off.abs() < OFF, "{off} m in cycle {cycle}");
    }
    let top = left[lifted..].iter().map(|p| p[2]).fold(0.0, f64::max);
    assert!(top > 0.45, "the box was lifted to {top} m only");
}

/// Rows 36 and 2 of the paper's promises: both arms by one command, in the same cycles.
#[test]
fn the_grippers_keep_their_distance_over_takeovers_in_motion() {
    let (text, left, right) = run(&[]);
    assert_eq!(text.matches("taken over at at_corner").count(), 2, "{text}");
    assert_together(&text, &left, &right);
    let over = begins(&text, "Over");
    let speed = distance(&left[over], &left[over - 1]) / DT;
    assert!(
        speed > 0.05,
        "the box stands still at the corner: {speed} m/s"
    );
    let change = (distance(&left[over + 1], &left[over]) / DT - speed).abs() / DT;
    assert!(change < 1.0, "it changes its speed at once: {change} m/s²");
}

#[test]
fn with_late_planners_the_box_stops_and_the_grippers_still_keep_their_distance() {
    let (text, left, right) = run(&["--planning-time", "20s"]);
    assert_eq!(text.matches("finished with up").count(), 2, "{text}");
    assert_together(&text, &left, &right);
}
