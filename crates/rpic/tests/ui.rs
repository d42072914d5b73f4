//! What the tools say of programs that nothing is wrong with before they are run or written: `tests/ui/testing` through
//! `rpic test`, `tests/ui/emitting` through `rpic compile --emit`. Each message stands beside its program;
//! `RPI_BLESS=1` writes them anew.

use std::path::Path;
use std::process::Command;

use rpi_testkit::{files_below, workspace_root};

#[test]
fn tests_say_what_stands_beside_them() {
    compare("testing", &["test"], ".rpi");
}

#[test]
fn forms_that_leave_something_out_say_so() {
    compare("emitting", &["compile", "--emit", "c"], ".rpinet");
    compare("emitting", &["compile", "--emit", "rpinet"], ".rpi");
    compare("emitting_lustre", &["compile", "--emit", "lustre"], ".rpi");
}

fn compare(folder: &str, task: &[&str], ending: &str) {
    let programs = files_below(&format!("tests/ui/{folder}"), &[ending]);
    assert!(!programs.is_empty(), "no programs in tests/ui/{folder}");
    let wrong: Vec<String> = programs
        .iter()
        .filter_map(|path| differs(path, task))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What is said of a program, if that is not what stands beside it.
fn differs(path: &Path, task: &[&str]) -> Option<String> {
    let root = workspace_root().join("tests/ui");
    let name = path
        .strip_prefix(&root)
        .expect("it is below")
        .display()
        .to_string();
    let output = Command::new(env!("CARGO_BIN_EXE_rpic"))
        .args(task)
        .arg(&name)
        .current_dir(&root)
        .env("NO_COLOR", "1")
        .output()
        .expect("it starts");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let expected = path.with_extension("stderr");
    if std::env::var_os("RPI_BLESS").is_some() {
        std::fs::write(&expected, &said).expect("tests/ui can be written");
    }
    let known = std::fs::read_to_string(&expected).unwrap_or_default();
    (known != said).then(|| format!("{name}\n--- says\n{said}--- but should say\n{known}"))
}
