//! Tasks with parallel branches (M11.6): they start and join in the same tick, an error in one ends the others, and the
//! next command follows without a gap.

use std::process::{Command, Output};

use serde_json::Value;

const COMMANDS: &str = "use io;

--| Counts on an output for so many cycles; ends at once when it is asked to.
command Count (io: AnalogueIo; cycles: int)
let
  n = 1 -> pre n + 1;
  io.set = [real(n), 0.0, 0.0, 0.0];
  export n;
  finish counted when n >= cycles;
  finish asked when cancel;
tel

--| As Count, but then it fails.
command Break (io: AnalogueIo; cycles: int)
let
  n = 1 -> pre n + 1;
  io.set = [real(n), 0.0, 0.0, 0.0];
  finish never when n < 0;
  fail broken when n >= cycles;
tel

--| Sets an output of each to what was counted before.
command Both (a, b: AnalogueIo) given (n: int)
let
  a.set = [real(n), 1.0, 0.0, 0.0];
  b.set = [real(n), 1.0, 0.0, 0.0];
  first_n = n -> pre first_n;
  export first_n;
  finish set when time >= 2[ms];
tel

";

const CELL: &str = "[devices.left]
kind = \"analogue-io\"
outputs = 4

[devices.right]
kind = \"analogue-io\"
outputs = 4
";

/// Runs a task with the commands above.
fn run(task: &str, options: &[&str]) -> (Option<i32>, Value, String) {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("program.rpi");
    std::fs::write(&program, format!("{COMMANDS}{task}")).unwrap();
    std::fs::write(folder.path().join("cell.toml"), CELL).unwrap();
    let mut rpi = Command::new(env!("CARGO_BIN_EXE_rpi"));
    let rpi = rpi.arg("run").arg(&program).arg("--json").args(options);
    let Output {
        status,
        stdout,
        stderr,
    } = rpi.env("NO_COLOR", "1").output().unwrap();
    let stderr = String::from_utf8_lossy(&stderr).into_owned();
    let summary = serde_json::from_slice(&stdout).unwrap_or(Value::Null);
    (status.code(), summary, stderr)
}

/// Returns name, first tick and number of cycles of each command, in the order of their starts.
fn times(summary: &Value) -> Vec<(String, u64, u64)> {
    let commands = summary["commands"].as_array().unwrap().iter();
    let times = commands.map(|c| {
        let name = c["name"].as_str().unwrap().to_owned();
        let first = c["first_tick"].as_u64().unwrap_or(u64::MAX);
        (name, first, c["cycles"].as_u64().unwrap())
    });
    let mut times: Vec<_> = times.collect();
    times.sort_by(|a, b| (a.1, &a.0).cmp(&(b.1, &b.0)));
    times
}

fn expect(summary: &Value, expected: &[(&str, u64, u64)]) {
    let times = times(summary);
    let times: Vec<(&str, u64, u64)> = times.iter().map(|t| (&*t.0, t.1, t.2)).collect();
    assert_eq!(times, expected, "{summary}");
}

#[test]
fn strands_begin_together_and_what_follows_has_no_gap() {
    let task = "task All (left, right: AnalogueIo)
let
  Count(left, 3);
  parallel
  let
    Count(left, 10);
    repeat 2 times let Count(left, 4); tel
  tel
  let
    Count(right, 30);
  tel
  Both(left, right);
tel
";
    let (code, summary, stderr) = run(task, &[]);
    assert_eq!(code, Some(0), "{stderr}");
    expect(
        &summary,
        &[
            ("Count(left, 3)", 0, 3),
            ("Count(left, 10)", 3, 10),
            ("Count(right, 30)", 3, 30),
            ("Count(left, 4)", 13, 4),
            ("Count(left, 4)", 17, 4),
            ("Both(left, right)", 33, 3),
        ],
    );
    assert_eq!(summary["late"], 0, "{summary}");
    assert_eq!(summary["devices"][0]["moving"], false);
}

/// A loop whose body runs nothing is left, and the next command runs.
#[test]
fn rounds_in_which_nothing_runs_are_passed() {
    let task = "task All (left: AnalogueIo)
let
  repeat 20000 times
  let
    repeat 30000 times let tel
    repeat 0 times let Count(left, 9); tel
  tel
  repeat 2 times let repeat 40000 times let tel Count(left, 2); tel
  Count(left, 3);
tel
";
    let (code, summary, stderr) = run(task, &[]);
    assert_eq!(code, Some(0), "{stderr}");
    let expected = [
        ("Count(left, 2)", 0, 2),
        ("Count(left, 2)", 2, 2),
        ("Count(left, 3)", 4, 3),
    ];
    expect(&summary, &expected);
}

#[test]
fn strands_begin_a_task_and_nest() {
    let task = "task All (left, right: AnalogueIo)
let
  parallel
  let
    parallel let Count(left, 5); tel let Wait(9); tel
    Count(left, 2);
  tel
  let Count(right, 3); tel
tel
command Wait (n: int) let finish over when time >= real(n - 1) * 1[ms]; tel
";
    let (code, summary, stderr) = run(task, &[]);
    assert_eq!(code, Some(0), "{stderr}");
    expect(
        &summary,
        &[
            ("Count(left, 5)", 0, 5),
            ("Count(right, 3)", 0, 3),
            ("Wait(9)", 0, 9),
            ("Count(left, 2)", 9, 2),
        ],
    );
}

/// The command after parallel branches starts in time whichever branch ends last, and takes over the values of the
/// first one.
#[test]
fn it_does_not_matter_which_strand_is_the_last() {
    for (one, other) in [(4, 9), (9, 4), (6, 6)] {
        let task = format!(
            "task All (left, right: AnalogueIo)\nlet\n  parallel\n  let Count(left, {one}); tel\n  let Count(right, {other}); tel\n  Both(left, right);\ntel\n"
        );
        let (code, summary, stderr) = run(&task, &[]);
        assert_eq!(code, Some(0), "{stderr}");
        let last = times(&summary).pop().unwrap();
        assert_eq!(last.1, one.max(other), "{summary}");
        assert_eq!(summary["late"], 0, "{summary}");
    }
}

#[test]
fn an_error_in_one_strand_ends_the_others_and_the_task() {
    let task = "task All (left, right: AnalogueIo)
let
  parallel
  let Count(left, 100); Count(left, 7); tel
  let Break(right, 5); tel
  Both(left, right);
tel
";
    let (code, summary, stderr) = run(task, &[]);
    assert_eq!(code, Some(1), "{stderr}");
    let times = times(&summary);
    assert_eq!(times.len(), 2, "{summary}");
    let regular = &summary["commands"][0]["end"];
    let broken = &summary["commands"][1]["end"];
    let ends = [regular, broken].map(|end| end["name"].as_str().unwrap());
    assert!(
        ends.contains(&"asked") && ends.contains(&"broken"),
        "{summary}"
    );
}

/// A task that continues after an error has not failed.
#[test]
fn a_branch_for_errors_follows_once_all_strands_have_ended() {
    let task = "task Inner (left, right: AnalogueIo)
let
  parallel
  let Count(left, 100); tel
  let Break(right, 5); tel
tel

task All (left, right: AnalogueIo)
let
  Inner(left, right) on fail then repair | on any then end;
  repair: Count(right, 2);
tel
";
    let (code, summary, stderr) = run(task, &["--command", "All"]);
    assert_eq!(code, Some(0), "{stderr} {summary}");
    let times = times(&summary);
    let names: Vec<&str> = times.iter().map(|t| t.0.as_str()).collect();
    assert_eq!(names.last(), Some(&"Count(right, 2)"), "{summary}");
    assert_eq!(times.len(), 3, "{summary}");
    let commands = summary["commands"].as_array().unwrap();
    let handled = commands.iter().filter(|c| c["handled"] == true);
    assert_eq!(handled.count(), 1, "{summary}");
}

#[test]
fn a_strand_can_end_early_and_go_its_own_ways() {
    let task = "task All (left, right: AnalogueIo)
let
  parallel
  let
    one: Break(left, 3) on broken then two | on any then end;
    three: Count(left, 50);
    two: Count(left, 4) on any then end;
  tel
  let Count(right, 20); tel
  Both(left, right);
tel
";
    let text = task.replace("Both(left, right);", "Count(left, 1);");
    let (code, summary, stderr) = run(&text, &[]);
    assert_eq!(code, Some(0), "{stderr}");
    expect(
        &summary,
        &[
            ("Break(left, 3)", 0, 3),
            ("Count(right, 20)", 0, 20),
            ("Count(left, 4)", 3, 4),
            ("Count(left, 1)", 20, 1),
        ],
    );
}

#[test]
fn one_device_in_two_strands_is_refused() {
    let direct = "task All (left: AnalogueIo) let parallel let Count(left, 1); tel let Count(left, 2); tel tel\n";
    let inner = "task Inner (a, b: AnalogueIo) let parallel let Count(a, 1); tel let Count(b, 2); tel tel\n";
    let through = format!("{inner}task All (left: AnalogueIo) let Inner(left, left); tel\n");
    for task in [direct, &through] {
        let (code, _, stderr) = run(task, &["--command", "All"]);
        assert_eq!(code, Some(2), "{stderr}");
        assert!(stderr.contains("RPI8005"), "{stderr}");
    }
}

/// Planning time does not delay the join beyond the end of the last branch, and a late successor is reported.
#[test]
fn a_late_successor_of_strands_is_told() {
    let task = "task All (left, right: AnalogueIo)
let
  parallel let Count(left, 5); tel let Count(right, 8); tel
  Both(left, right);
tel
";
    let (code, summary, stderr) = run(task, &["--planning-time", "50ms"]);
    assert_eq!(code, Some(0), "{stderr}");
    assert_eq!(summary["late"], 1, "{summary}");
    assert_eq!(summary["missed"], 0, "{summary}");
    assert!(times(&summary).last().unwrap().1 >= 8, "{summary}");
}
