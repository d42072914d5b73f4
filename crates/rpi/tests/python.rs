//! The client in Python against this server: its own tests, where there is a Python.

use std::io::Write;
use std::process::Command;

/// Asyncio and the forms of types that the client uses came with this version.
const SINCE: &str = "import sys; sys.exit(sys.version_info < (3, 10))";

#[test]
fn the_python_client_drives_the_server() {
    let python = ["python3", "python"].into_iter().find(|name| {
        let there = Command::new(name).args(["-c", SINCE]).status();
        there.is_ok_and(|status| status.success())
    });
    let Some(python) = python else {
        // Past the harness, which captures prints of tests that pass.
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
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    // Tests that were passed over say so here.
    println!("{}", said.lines().last().unwrap_or_default());
}
