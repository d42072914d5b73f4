//! What `rpi run` says of a node in whose cycles something goes wrong: `tests/ui/running/NAME.rpi` on `NAME.csv` says
//! `NAME.stderr`. `RPI_BLESS=1` writes the messages anew.

use std::path::Path;
use std::process::Command;

use rpi_testkit::{files_below, workspace_root};

#[test]
fn runs_say_what_stands_beside_them() {
    let programs = files_below("tests/ui/running", &[".rpi", ".lus"]);
    assert!(!programs.is_empty(), "no programs in tests/ui/running");
    let wrong: Vec<String> = programs.iter().filter_map(|path| differs(path)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What is said of a program, if that is not what stands beside it.
fn differs(path: &Path) -> Option<String> {
    let root = workspace_root().join("tests/ui");
    let name = path
        .strip_prefix(&root)
        .expect("it is below")
        .display()
        .to_string();
    let output = Command::new(env!("CARGO_BIN_EXE_rpi"))
        .args(["run", &name, "--inputs"])
        .arg(path.with_extension("csv"))
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
