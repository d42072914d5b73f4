//! What a command takes over from the one that it follows (M7.3).

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

/// What `left` was in each cycle of `Cut`.
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
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    let rows = std::fs::read_to_string(&record).unwrap();
    let of_left = rows.lines().filter(|row| row.contains("left"));
    let value = |row: &str| row.rsplit(',').next().unwrap_or_default().to_owned();
    of_left.map(value).collect()
}

/// The values of the predecessor's last cycle, in all cycles; a default where it exports nothing.
#[test]
fn a_command_takes_over_what_its_predecessor_exported_last() {
    assert_eq!(left(&[]), ["10.06", "10.06", "10.06"]);
}

/// A successor that was not loaded in time starts later, with the same values.
#[test]
fn who_starts_late_takes_over_the_same() {
    assert_eq!(
        left(&["--planning-time", "1s"]),
        ["10.06", "10.06", "10.06"]
    );
}
