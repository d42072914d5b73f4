//! The committed coefficients and tables are those that the generator computes.

mod common;

use std::path::Path;
use std::process::Command;

use common::report_skip;

#[test]
fn coefficients_and_tables_are_those_of_the_generator() {
    let available = Command::new("python3")
        .args(["-c", "import mpmath"])
        .output();
    if !available.is_ok_and(|output| output.status.success()) {
        report_skip("coefficients and tables: there is no Python 3 with mpmath");
        return;
    }
    let output = Command::new("python3")
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/generate.py"))
        .arg("--check")
        .output()
        .expect("Python 3");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}
