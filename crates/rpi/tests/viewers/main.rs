//! Recordings as other tools read them.

#[path = "../support/mod.rs"]
mod support;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use support::{output_text, rpi};

/// Returns a Python with the packages for MCAP and ROS 2 messages: the one that `.ci/run` sets up, or that of the system.
fn python() -> Option<PathBuf> {
    let own = rpi_testkit::workspace_root().join("target/python/bin/python");
    let has_packages = |python: &PathBuf| {
        let output = Command::new(python)
            .args(["-c", "import mcap, mcap_ros2"])
            .output();
        output.is_ok_and(|output| output.status.success())
    };
    [own, "python3".into()].into_iter().find(has_packages)
}

/// The packages of the MCAP project decode every message, and the transforms lead to the place of the tool.
#[test]
fn ros2_tools_read_a_recording() {
    let Some(python) = python() else {
        // Writes past the test harness, which captures the output of passing tests.
        let line = b"SKIPPED: recordings for ROS 2: no Python with mcap and mcap-ros2-support\n";
        return std::io::stderr().write_all(line).unwrap();
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out.mcap");
    let program = rpi_testkit::workspace_root().join("examples/blending/blending.rpi");
    let (program, name) = (program.to_str().unwrap(), file.to_str().unwrap());
    let run = rpi(&[
        "run",
        program,
        "--record",
        name,
        "--profile",
        "ros2",
        "--time",
        "3s",
    ]);
    assert_eq!(run.status.code(), Some(0), "{}", output_text(&run));
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/viewers/ros2.py");
    let output = Command::new(python)
        .arg(script)
        .arg(&file)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", output_text(&output));
    println!("{}", output_text(&output));
}
