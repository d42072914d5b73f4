//! The bundle of the page is small and up to date with its sources.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Maximum size of the bundle in bytes.
const MAX_BYTES: usize = 1_500_000;

fn web() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("web")
}

/// Runs a command in the folder of the page. Returns its output, and whether it succeeded.
fn run(program: &str, arguments: &[&str]) -> (bool, String) {
    let output = Command::new(program)
        .args(arguments)
        .current_dir(web())
        .output()
        .unwrap_or_else(|error| panic!("{program}: {error}"));
    let [out, err] = [&output.stdout, &output.stderr].map(|b| String::from_utf8_lossy(b));
    (output.status.success(), format!("{out}{err}"))
}

fn has_node() -> bool {
    let node = Command::new("node").arg("--version").output();
    node.is_ok_and(|output| output.status.success()) && web().join("node_modules").exists()
}

/// Reports a skipped test past the test harness, which captures the output of passing tests.
fn report_skip(what: &str) {
    let line =
        format!("SKIPPED: {what}: no Node, or `npm ci` was not run in crates/rpi-view/web\n");
    std::io::stderr().write_all(line.as_bytes()).unwrap();
}

#[test]
fn the_bundle_is_small_and_names_its_licences() {
    let page = std::fs::read_to_string(web().join("dist/page.html")).unwrap();
    assert!(page.len() < MAX_BYTES, "{} bytes", page.len());
    for package in ["three ", "uplot "] {
        let head = &page[..page.find("-->").unwrap()];
        assert!(head.contains(package), "{package}: no licence");
    }
    // The page loads nothing from a network.
    for source in ["src=\"http", "href=\"http", "@import", "url(http"] {
        assert!(!page.contains(source), "{source}");
    }
}

#[test]
fn the_bundle_is_up_to_date() {
    if !has_node() {
        return report_skip("bundle of the page");
    }
    let (ok, output) = run("node", &["build.mjs", "--check"]);
    assert!(ok, "{output}");
}

#[test]
fn the_sources_have_no_type_errors() {
    if !has_node() {
        return report_skip("types of the page");
    }
    let (ok, output) = run("node", &["node_modules/typescript/bin/tsc", "--noEmit"]);
    assert!(ok, "{output}");
}
