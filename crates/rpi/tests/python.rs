//! Runs the tests of the Python client against this server, if Python is installed.

use std::io::Write;
use std::process::Command;

/// Asyncio and the type annotations of the client require this version.
const SINCE: &str = "import sys; sys.exit(sys.version_info < (3, 10))";

#[test]
fn the_python_client_drives_the_server() {
    let python = ["python3", "python"].into_iter().find(|name| {
        let there = Command::new(name).args(["-c", SINCE]).status();
        there.is_ok_and(|status| status.success())
    });
    let Some(python) = python else {
        // Writes past the test harness, which captures the output of passing tests.
        let line = b"SKIPPED: the Python client: there is no Python 3.10 or later\n";
        return std::io::stderr().write_all(line).unwrap();
    };
    let output = Command::new(python)
        .args(["-W", "error", "-m", "unittest", "discover", "-s", "tests"])
        .current_dir(rpi_testkit::workspace_root().join("clients/python"))
        .env("RPI", env!("CARGO_BIN_EXE_rpi"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{stderr}");
    // The last line shows how many tests were skipped.
    println!("{}", stderr.lines().last().unwrap_or_default());
}
