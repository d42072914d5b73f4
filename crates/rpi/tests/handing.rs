//! Values that a command takes over from its predecessor (M7.3).

use std::process::Command;

const PROGRAM: &str = "
command Measure ()
let
  n = 1 -> pre n + 1;
  length = 20[mm] * real n;
  export length, n;
  finish measured when n = 3;
tel

command Cut () given (length: real[m]; n: int; spare: int = 7)
let
  left = length + 1[m] * real (n + spare);
  export left;
  finish cut when time >= 2[ms];
tel

task Both ()
let
  Measure();
  Cut();
tel
";

/// Returns the value of `left` in each cycle of `Cut`.
fn left(options: &[&str]) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("both.rpi");
    let record = folder.path().join("both.csv");
    std::fs::write(&program, PROGRAM).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .args(["run", "--command", "Both", "--record"])
        .args([&record, &program])
        .args(options)
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let rows = std::fs::read_to_string(&record).unwrap();
    let of_left = rows.lines().filter(|row| row.contains("left"));
    let value = |row: &str| row.rsplit(',').next().unwrap_or_default().to_owned();
    of_left.map(value).collect()
}

/// The values are those of the predecessor's last cycle, in all cycles; the default if it does not export them.
#[test]
fn a_command_takes_over_what_its_predecessor_exported_last() {
    assert_eq!(left(&[]), ["10.06", "10.06", "10.06"]);
}

/// A successor that was loaded too late starts later, with the same values.
#[test]
fn who_starts_late_takes_over_the_same() {
    assert_eq!(
        left(&["--planning-time", "1s"]),
        ["10.06", "10.06", "10.06"]
    );
}

/// A command that runs alone has no predecessor: an input without a default must be set, and is not 0.
#[test]
fn what_nobody_hands_over_must_be_set() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("both.rpi");
    std::fs::write(&program, PROGRAM).unwrap();
    let run = |options: &[&str]| {
        let run = ["run", "--command", "Cut"];
        let mut command = Command::new(env!("CARGO_BIN_EXE_rpi"));
        let output = command.args(run).args(options).arg(&program).output();
        let output = output.unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), stderr)
    };
    let (code, stderr) = run(&[]);
    assert_eq!(code, Some(2), "{stderr}");
    let needs = "Cut takes over length, n but no command runs before it";
    assert!(stderr.contains(needs), "{stderr}");
    let (code, stderr) = run(&["--set", "length=0.5"]);
    assert_eq!(code, Some(2), "{stderr}");
    assert!(stderr.contains("--set n=VALUE"), "{stderr}");
    let (code, stderr) = run(&["--set", "length=0.5", "--set", "n=2"]);
    assert_eq!(code, Some(0), "{stderr}");
}
