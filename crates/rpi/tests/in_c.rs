//! `rpi run --node N --target c` and `rpi replay --against c`: programs in C beside the core.

mod support;

use std::path::{Path, PathBuf};
use std::process::Command;

use rpi_testkit::{files_below, report_skip, workspace_root};
use support::recordings::record;
use support::{output_text, rpi};

fn answers(program: &str) -> bool {
    let found = Command::new(program).arg("--version").output().is_ok();
    if !found {
        report_skip(&format!("{program} is not installed"));
    }
    found
}

/// Runs a program on the table beside it, in the core and in C. Returns the summary of the run in C.
fn run_in_c(program: &Path, compiler: &str) -> String {
    let (path, inputs) = (text(program), text(&program.with_extension("in.csv")));
    let target = ["--target", "c", "--cc", compiler];
    let output = rpi(&[&["run", &path, "--inputs", &inputs][..], &target[..]].concat());
    let summary = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{path}\n{summary}");
    let wanted =
        std::fs::read(program.with_extension("out.csv")).expect("a table stands beside it");
    assert_eq!(output.stdout, wanted, "{path}");
    assert!(summary.contains("the same bits in C"), "{path}\n{summary}");
    summary
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

fn programs() -> Vec<PathBuf> {
    let mut programs = files_below("tests/lustre", &[".lus"]);
    programs.extend(files_below("tests/nodes", &[".rpi"]));
    programs
}

#[test]
fn tables_are_the_same_in_c() {
    if answers("gcc") {
        for program in programs().iter().step_by(4) {
            run_in_c(program, "gcc -O1");
        }
    }
}

/// A tenth of the tables and a motion of seven joints, on the board mps2-an386 with a Cortex-M4.
#[test]
fn tables_are_the_same_on_a_microcontroller() {
    if answers("arm-none-eabi-gcc") && answers("qemu-system-arm") {
        let joints = workspace_root().join("crates/rpi/tests/programs/seven_joints.rpi");
        for program in programs().iter().step_by(10).chain([&joints]) {
            let summary = run_in_c(program, "cortex-m4");
            println!("{}: {summary}", program.display());
            for figure in ["flash ", " B, RAM ", " per cycle"] {
                assert!(summary.contains(figure), "{summary}");
            }
            assert!(!summary.contains(" 0 instructions"), "{summary}");
        }
    }
}

#[test]
fn a_recording_gives_the_same_bits_in_c() {
    if !answers("gcc") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (file, _) = record(folder.path(), &["--time", "7s"]);
    let file = text(&file);
    let output = rpi(&["replay", &file, "--against", "c", "--cc", "gcc -O1"]);
    let report = output_text(&output);
    assert_eq!(output.status.code(), Some(0), "{report}");
    assert!(
        report.contains("the same bits in C (gcc -O1) in 7"),
        "{report}"
    );
    // A compiler that changes a constant stands for one that changes the meaning of the program.
    let script = folder.path().join("cc.sh");
    let edit = "sed -i 's/^  out->\\(.*\\) = true;/  out->\\1 = false;/' program.c";
    std::fs::write(&script, format!("{edit}\nexec gcc \"$@\"\n")).unwrap();
    let compiler = format!("sh {}", text(&script));
    let output = rpi(&["replay", &file, "--against", "c", "--cc", &compiler]);
    let report = output_text(&output);
    assert_eq!(output.status.code(), Some(1), "{report}");
    assert!(report.contains("DIFFERENT in tick"), "{report}");
}

#[test]
fn commands_are_referred_to_recordings() {
    let program = workspace_root().join("examples/first/first.rpi");
    let output = rpi(&["run", &text(&program), "--target", "c"]);
    let report = output_text(&output);
    assert_eq!(output.status.code(), Some(2), "{report}");
    assert!(
        report.contains("rpi replay FILE.mcap --against c"),
        "{report}"
    );
}
