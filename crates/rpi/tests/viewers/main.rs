//! Recordings as other tools read them.

#[path = "../support/mod.rs"]
mod support;

use std::ffi::OsStr;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use support::{output_text, rpi};

/// Returns a Python with these modules: the one that `.ci/run` sets up, or that of the system. Without one, reports that the test
/// of `what` is skipped.
fn python(modules: &str, what: &str) -> Option<PathBuf> {
    let own = rpi_testkit::workspace_root().join("target/python/bin/python");
    let has_modules = |python: &PathBuf| {
        let import = format!("import {modules}");
        let output = Command::new(python).args(["-c", &import]).output();
        output.is_ok_and(|output| output.status.success())
    };
    let python = [own, "python3".into()].into_iter().find(has_modules);
    if python.is_none() {
        // Writes past the test harness, which captures the output of passing tests.
        let line = format!("SKIPPED: {what}: no Python with {modules}\n");
        std::io::stderr().write_all(line.as_bytes()).unwrap();
    }
    python
}

/// Returns a Python that reads recordings for ROS 2.
fn python_for_ros2() -> Option<PathBuf> {
    python("mcap, mcap_ros2", "recordings for ROS 2")
}

/// Runs a script of this folder, which must succeed.
fn run_script(python: &Path, script: &str, arguments: &[impl AsRef<OsStr>]) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/viewers");
    let mut command = Command::new(python);
    let output = command
        .arg(folder.join(script))
        .args(arguments)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", output_text(&output));
    println!("{}", output_text(&output));
}

/// Runs the tool, which must succeed.
fn succeeds(arguments: &[&str]) {
    let output = rpi(arguments);
    assert_eq!(output.status.code(), Some(0), "{}", output_text(&output));
}

/// The same packages read a part of a recording, and merged recordings.
#[test]
fn ros2_tools_read_parts_and_merged_recordings() {
    let Some(python) = python_for_ros2() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let [file, part, merged] =
        ["out", "part", "merged"].map(|name| folder.path().join(format!("{name}.mcap")));
    let program = rpi_testkit::workspace_root().join("examples/blending/blending.rpi");
    let [out, cut, both] = [&file, &part, &merged].map(|path| path.to_str().unwrap());
    let run = [
        "run",
        program.to_str().unwrap(),
        "--record",
        out,
        "--profile",
        "ros2",
        "--time",
        "3s",
    ];
    succeeds(&run);
    succeeds(&[
        "recording",
        "cut",
        out,
        "--from",
        "1s",
        "--to",
        "2s",
        "--out",
        cut,
    ]);
    succeeds(&["recording", "merge", out, cut, "--out", both]);
    run_script(&python, "edits.py", &[&file, &part, &merged]);
}

/// The packages of the MCAP project decode every message, and the transforms lead to the place of the tool.
#[test]
fn ros2_tools_read_a_recording() {
    let Some(python) = python_for_ros2() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out.mcap");
    let program = rpi_testkit::workspace_root().join("examples/blending/blending.rpi");
    let (program, name) = (program.to_str().unwrap(), file.to_str().unwrap());
    succeeds(&[
        "run",
        program,
        "--record",
        name,
        "--profile",
        "ros2",
        "--time",
        "3s",
    ]);
    run_script(&python, "ros2.py", &[&file]);
}

/// The reference implementation of Arrow reads the same tables as in CSV.
#[test]
fn pyarrow_reads_tables() {
    let Some(python) = python("pyarrow", "tables in Arrow and Parquet") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let [file, csv, parquet, arrow] =
        ["out.mcap", "out.csv", "out.parquet", "out.arrow"].map(|name| folder.path().join(name));
    let program = rpi_testkit::workspace_root().join("examples/blending/blending.rpi");
    let (program, recording) = (program.to_str().unwrap(), file.to_str().unwrap());
    succeeds(&["run", program, "--record", recording, "--time", "9s"]);
    for table in [&csv, &parquet, &arrow] {
        succeeds(&[
            "export",
            recording,
            "--output",
            table.to_str().unwrap(),
            "--watch",
            "MoveToE.way",
        ]);
    }
    run_script(&python, "tables.py", &[&csv, &parquet, &arrow]);
}

/// Process that ends with the test.
struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A program with a package of others for websockets gets live messages: joint states, and a flow that is not exported.
#[test]
fn a_client_of_the_published_protocol_gets_live_messages() {
    let Some(python) = python("websockets", "live messages for Foxglove") else {
        return;
    };
    let program = rpi_testkit::workspace_root().join("examples/blending/blending.rpi");
    let mut run = Command::new(env!("CARGO_BIN_EXE_rpi"));
    run.arg("run").arg(program);
    run.args(["--real-time", "--foxglove", "0", "--watch", "MoveToA.way"]);
    let mut run = Process(
        run.stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap(),
    );
    let lines = BufReader::new(run.0.stderr.take().unwrap()).lines();
    let mut lines = lines.map(|line| line.unwrap());
    let address = lines.find_map(|line| {
        let (_, address) = line.split_once("live messages for Foxglove at ")?;
        Some(address.to_owned())
    });
    let address = address.expect("the run prints the address");
    let arguments = [address.as_str(), "/command/MoveToA", "way.speed"];
    run_script(&python, "foxglove.py", &arguments);
}
