//! `rpic test --target c`: the tests of programs in C beside the core.

use std::path::Path;
use std::process::{Command, Output};

use rpi_testkit::{report_skip, workspace_root};

fn rpic(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rpic"))
        .args(args)
        .env("NO_COLOR", "1")
        .current_dir(workspace_root())
        .output()
        .unwrap()
}

/// Runs tests in C. Returns the exit status and the output.
fn run(path: &str, compiler: &str) -> (Option<i32>, String) {
    let output = rpic(&["test", path, "--target", "c", "--cc", compiler]);
    let text = [output.stdout, output.stderr].concat();
    (
        output.status.code(),
        String::from_utf8_lossy(&text).into_owned(),
    )
}

fn has_gcc() -> bool {
    let found = Command::new("gcc").arg("--version").output().is_ok();
    if !found {
        report_skip("gcc is not installed");
    }
    found
}

#[test]
fn tests_of_examples_pass_in_c() {
    if has_gcc() {
        let (status, text) = run("examples", "gcc -O2");
        assert_eq!(status, Some(0), "{text}");
        assert!(text.contains("a stuck motor trips"), "{text}");
    }
}

#[test]
fn tests_of_the_language_pass_in_c() {
    if has_gcc() {
        let (status, text) = run("tests/meaning", "gcc -O0");
        assert_eq!(status, Some(0), "{text}");
    }
}

/// A compiler that changes a constant stands for one that changes the meaning of the program.
#[test]
fn a_difference_fails_the_test_with_cycle_and_values() {
    if !has_gcc() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (program, script) = (folder.path().join("a.rpi"), folder.path().join("cc.sh"));
    std::fs::write(
        &program,
        "test \"halves\"\nlet\n  y = 1.0 -> pre y * 0.5;\n  assert y <= 1.0;\n  finish done when y < 0.1;\ntel\n",
    )
    .unwrap();
    std::fs::write(
        &script,
        "sed -i 's/\\* 0\\.5/* 0.25/' program.c\nexec gcc \"$@\"\n",
    )
    .unwrap();
    let compiler = format!("sh {}", script.display());
    let (status, text) = run(&text_of(&program), &compiler);
    assert_eq!(status, Some(1), "{text}");
    for part in ["differs from the core: cycle 1", "0 passed, 1 failed"] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

#[test]
fn a_compiler_that_is_missing_is_named() {
    let (status, text) = run("examples/motor/motor.rpi", "no-such-compiler -O2");
    assert_eq!(status, Some(2), "{text}");
    assert!(text.contains("no-such-compiler"), "{text}");
}

fn text_of(path: &Path) -> String {
    path.display().to_string()
}
