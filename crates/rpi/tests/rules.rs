//! Rules of the semantics that need a run: which result counts, and the effect of a fault.

use std::path::Path;
use std::process::Command;

/// Runs a program on the cell of the first example. Returns the outcome and the recorded rows.
fn run(program: &str) -> (serde_json::Value, String) {
    let folder = tempfile::tempdir().unwrap();
    let [path, cell, record] =
        ["program.rpi", "cell.toml", "record.csv"].map(|n| folder.path().join(n));
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/first/cell.toml");
    std::fs::write(&path, program).unwrap();
    std::fs::copy(example, cell).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .args(["run", "--json", "--record"])
        .args([&record, &path])
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    let outcome = serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{stderr}"));
    (outcome, std::fs::read_to_string(record).unwrap())
}

/// Returns the ending of a command whose results all come true in one cycle.
fn end(results: &str) -> serde_json::Value {
    let program = format!("command Both\nlet\n  n = 0 -> pre n + 1;\n{results}tel\n");
    run(&program).0["commands"][0]["end"].clone()
}

/// Rule M10.1.
#[test]
fn an_error_goes_before_other_results_then_the_order_of_the_text() {
    let of_errors = end(
        "finish a when n = 2;\nfail b when n = 2;\nfail c when n >= 2 and n < 9;\nfinish z when n > 9;\n",
    );
    assert_eq!(of_errors["how"], "error", "{of_errors}");
    assert_eq!(
        [&of_errors["name"], &of_errors["number"]],
        [&"b".into(), &serde_json::json!(1)]
    );
    let of_others = end("fail e when n > 9;\nfinish a when n >= 2;\nfinish b when n = 2;\n");
    assert_eq!(of_others["name"], "a", "{of_others}");
}

/// Rule M2.2: the set-point of the cycle is dropped, and the device stops within its own limits.
#[test]
fn a_fault_ends_the_command_and_the_arm_stops_by_itself() {
    let program = "use motion;
command Fault (arm: Arm)
let
  n = 0 -> pre n + 1;
  ahead = pose(100[mm], 0[mm], 0[mm], 0[deg], 0[deg], 0[deg]);
  way = Line(arm, arm.pose * ahead);
  arm.tcp = way.pose;
  share = 10 div (50 - n);
  export share;
  finish there when way.done;
  fail broken when arm.error;
tel
";
    let (outcome, rows) = run(program);
    let command = &outcome["commands"][0];
    assert_eq!(command["end"]["how"], "fault", "{outcome}");
    assert_eq!(command["cycles"], 51);
    assert_eq!(outcome["devices"][0]["moving"], false);
    let of_arm = rows
        .lines()
        .filter(|row| row.contains("arm.tcp.commanded_position"));
    let places: Vec<&str> = of_arm
        .filter_map(|row| row.split_once(','))
        .map(|r| r.1)
        .collect();
    assert!(
        places.len() > 60,
        "it goes on after the fault: {}",
        places.len()
    );
    assert_ne!(places[50], places[52], "it does not stand still at once");
    let last = &places[places.len() - 2..];
    assert_eq!(last[0], last[1], "it stands in the end");
}

/// A fault of a command is reported with location, cycle and cause.
#[test]
fn a_fault_of_a_command_has_its_place_in_the_text() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.rpi");
    let counter = "node Counter (on: bool) returns (n: int)
con
  guarantee \"small\" n < 3;
noc
let
  n = 0 -> pre n + (if on then 1 else 0);
tel
command Count
let
  n = Counter(true);
  finish over when n > 9;
tel
";
    let divided = counter.replace("pre n +", "pre n + 0 div (pre n - 2) +");
    let kept = "the guarantee \"small\" of `Counter` is not kept";
    let cases = [
        (counter, "fault", 3, kept),
        (&divided, "off", 6, "integer division by zero"),
    ];
    for (text, contracts, line, what) in cases {
        std::fs::write(&path, text).unwrap();
        for json in [false, true] {
            let mut rpi = Command::new(env!("CARGO_BIN_EXE_rpi"));
            rpi.args(["run", "--contracts", contracts]).arg(&path);
            let output = rpi.args(json.then_some("--json")).output().unwrap();
            assert_eq!(output.status.code(), Some(3));
            let [out, err] =
                [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
            let place = format!("program.rpi:{line}:");
            let out = out.replace("\\\"", "\"");
            assert!(out.contains(&place) && out.contains(what), "{out}");
            assert!(err.contains("RPI9011") && err.contains(&place), "{err}");
            let cycle = format!("cycle 3 of `Count`: {what}");
            assert!(err.contains(&cycle), "{err}");
            let values = ["guaranteed here", "in this cycle n = 3", "in the call `n`"];
            let reported = values.map(|part| err.contains(part));
            assert_eq!(reported, [contracts == "fault"; 3], "{err}");
            assert_eq!(
                err.matches("RPI90").count(),
                2,
                "reported once, with its page: {err}"
            );
        }
    }
}

/// A violated claim is reported with the run of the command in which it was violated.
#[test]
fn a_claim_of_a_task_is_told_with_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.rpi");
    let text = "command Count (most: int)
let
  n = 0 -> pre n + 1;
  assert \"few\" n <= most;
  finish over when n = 4;
tel
task Both
let
  Count(9);
  Count(2);
tel
";
    std::fs::write(&path, text).unwrap();
    let mut rpi = Command::new(env!("CARGO_BIN_EXE_rpi"));
    let output = rpi.arg("run").arg(&path).output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert!(err.contains("does not hold in cycle 3"), "{err}");
    assert!(err.contains("from 0.005 s on"), "{err}");
}

/// A set-point refused by a device makes the run a fault, unless a command handles it.
#[test]
fn what_a_device_refuses_is_no_good_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(
        path("cell.toml"),
        "[devices.arm]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\n",
    )
    .unwrap();
    let later = "tel\ncommand Miss\nlet\n  finish found when time > 1[s];\n  fail nothing when time > 5[ms] and time < 9[s];\n";
    let both = format!(
        "{later}tel\ntask Both (arm: Arm)\nlet\n  Jump(arm);\n  Miss() on fail then end | on any then end;\n"
    );
    for (minds, status, how) in [
        ("", 3, "finished with over"),
        ("  fail arm_error when arm.error;\n", 1, "arm_error"),
        // A later, handled error is unrelated to the refused set-point.
        (both.as_str(), 3, "nothing"),
    ] {
        let text = format!(
            "use motion;
command Jump (arm: Arm)
let
  arm.joints = [0.5[rad], 0[rad], 0[rad], 0[rad], 0[rad], 0[rad], 0[rad]];
  finish over when time > 20[ms];
{minds}tel
"
        );
        std::fs::write(path("program.rpi"), text).unwrap();
        let mut rpi = Command::new(env!("CARGO_BIN_EXE_rpi"));
        let output = rpi.arg("run").arg(path("program.rpi")).output().unwrap();
        let out = String::from_utf8(output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(status), "{out}");
        assert!(out.contains(how) && out.contains("discontinuity"), "{out}");
    }
}
