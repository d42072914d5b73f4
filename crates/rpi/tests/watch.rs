//! Watched flows: values of flows that a program does not export, which change nothing else in the run.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Values of a run: for each flow, its values by cycle.
type Rows = BTreeMap<String, Vec<(u64, String)>>;

const PROGRAM: &str = "
node Smooth (x: real) returns (y: real)
var last: real;
let
  last = 0.0 -> pre y;
  y = last + 0.25 * (x - last);
tel

node Deep (x: real) returns (y: real)
let
  inner = Smooth(2.0 * x);
  y = inner + 1.0;
tel

command Main ()
var n: int;
let
  n = 0 -> pre n + 1;
  level = Deep(real n);
  fragment Late when n >= 3
  let
    from_three = n - 3;
    slow = Smooth(real from_three);
  tel
  export level;
  finish over when n = 9;
tel
";

/// Runs a program with options. Returns the exit status, what it printed to standard error, and its recorded rows.
fn run(program: &Path, options: &[&str]) -> (i32, String, Rows) {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("rows.jsonl");
    let output = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .args(["run", program.to_str().unwrap(), "--record"])
        .arg(&record)
        .args(options)
        .env("NO_COLOR", "1")
        .output()
        .unwrap();
    let mut rows = Rows::new();
    for line in std::fs::read_to_string(&record).unwrap_or_default().lines() {
        let row: serde_json::Value = serde_json::from_str(line).unwrap();
        let (cycle, flow) = (
            row["cycle"].as_u64().unwrap(),
            row["flow"].as_str().unwrap(),
        );
        let value = row["value"].to_string();
        rows.entry(flow.to_owned())
            .or_default()
            .push((cycle, value));
    }
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code().unwrap(), message, rows)
}

fn with_program(check: impl FnOnce(&Path)) {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("program.rpi");
    std::fs::write(&program, PROGRAM).unwrap();
    check(&program);
}

/// Returns the rows of the flows whose names end with `name`.
fn rows<'r>(rows: &'r Rows, name: &str) -> &'r [(u64, String)] {
    let mut found = rows.iter().filter(|(flow, _)| flow.ends_with(name));
    let (_, values) = found
        .next()
        .unwrap_or_else(|| panic!("no {name}: {:?}", rows.keys()));
    values
}

#[test]
fn flows_of_calls_and_fragments_are_recorded_under_their_paths() {
    with_program(|program| {
        let (status, message, watched) = run(program, &["--watch", "Main"]);
        assert_eq!(status, 0, "{message}");
        let numbers = |name: &str| -> Vec<f64> {
            rows(&watched, name)
                .iter()
                .filter_map(|(_, value)| value.parse().ok())
                .collect()
        };
        let level = numbers("level");
        let inner = numbers("level.inner.y");
        let sums: Vec<f64> = inner.iter().map(|y| y + 1.0).collect();
        assert_eq!(level, sums);
        assert_eq!(numbers("level.inner.last")[1..], inner[..inner.len() - 1]);
        // A flow of a fragment has values only while the fragment is active.
        assert_eq!(
            numbers("Late.from_three"),
            [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
        );
        assert_eq!(numbers("Late.slow.y").len(), 7);
    });
}

#[test]
fn a_watched_call_stands_for_the_flows_inside() {
    with_program(|program| {
        let (_, _, watched) = run(program, &["--watch", "Main.level.inner"]);
        let inside = watched
            .keys()
            .filter(|flow| flow.contains("inner."))
            .count();
        assert_eq!(inside, 3, "{:?}", watched.keys());
        assert!(!watched.keys().any(|flow| flow.contains("Late")));
    });
}

#[test]
fn an_unknown_flow_is_an_error_with_a_suggestion() {
    with_program(|program| {
        let (status, message, _) = run(program, &["--watch", "Main.level.iner"]);
        assert_ne!(status, 0);
        assert!(
            message.contains("did you mean `Main.level.inner`"),
            "{message}"
        );
    });
}

/// All values that a run has with and without watched flows are the same.
#[test]
fn watching_changes_no_value() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    for (program, commands) in [
        ("lifting/lifting.rpi", ["Over", "Back"]),
        ("blending/blending.rpi", ["MoveToC", "MoveToE"]),
    ] {
        let program = root.join(program);
        let (status, message, plain) = run(&program, &["--time", "4s"]);
        let options = [
            "--time",
            "4s",
            "--watch",
            commands[0],
            "--watch",
            commands[1],
        ];
        let (watched_status, watched_message, watched) = run(&program, &options);
        assert_eq!(status, watched_status, "{message}{watched_message}");
        assert!(watched.len() > plain.len() + 20, "{}", watched.len());
        for (flow, values) in &plain {
            assert_eq!(Some(values), watched.get(flow), "{flow}");
        }
    }
}

/// Returns the columns of a table by name: the values that are not empty.
fn columns(table: &str) -> BTreeMap<String, Vec<String>> {
    let mut rows = table.lines().map(|line| line.split(',').map(str::to_owned));
    let names: Vec<String> = rows.next().unwrap().collect();
    let mut columns: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for row in rows {
        for (name, value) in names.iter().zip(row).filter(|(_, value)| !value.is_empty()) {
            columns.entry(name.clone()).or_default().push(value);
        }
    }
    columns
}

/// A recording without a flow gives the values that the flow had: the recording is replayed.
#[test]
fn flows_that_were_not_recorded_are_computed_again() {
    with_program(|program| {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        let rpi = |arguments: &[&str]| {
            let output = Command::new(env!("CARGO_BIN_EXE_rpi"))
                .args(arguments)
                .output()
                .unwrap();
            let message = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(0), "{message}");
            String::from_utf8(output.stdout).unwrap()
        };
        let program = program.to_str().unwrap();
        rpi(&["run", program, "--record", &file("plain.mcap")]);
        rpi(&[
            "run",
            program,
            "--record",
            &file("watched.mcap"),
            "--watch",
            "Main",
        ]);
        let plain = columns(&rpi(&["export", &file("plain.mcap")]));
        assert!(
            !plain.keys().any(|name| name.contains("inner")),
            "{plain:?}"
        );
        let watched = columns(&rpi(&["export", &file("watched.mcap")]));
        let replayed = columns(&rpi(&["export", &file("plain.mcap"), "--watch", "Main"]));
        assert_eq!(watched, replayed);
        // A recording with watched flows is replayed with others, too.
        let flow = "Main.Late.from_three";
        for watch in ["Main", flow, "Main.level.inner"] {
            let name = file(&format!("{watch}.mcap"));
            rpi(&["run", program, "--record", &name, "--watch", watch]);
            let again = columns(&rpi(&["export", &name, "--watch", "Main"]));
            assert_eq!(again, replayed, "{watch}");
            assert!(rpi(&["why", &name, flow]).starts_with("Late.from_three = 6 at"));
        }
        assert_eq!(
            replayed["/command/Main/Late.from_three"],
            ["0", "1", "2", "3", "4", "5", "6"]
        );
    });
}
