//! Robot descriptions and cells that name them, from the command line to the motion.

use std::path::Path;
use std::process::{Command, Output};

fn rpi(arguments: &[&str], folder: &Path) -> Output {
    let rpi = env!("CARGO_BIN_EXE_rpi");
    let run = Command::new(rpi)
        .args(arguments)
        .current_dir(folder)
        .output();
    run.expect("rpi starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn check_prints_what_a_description_gives_and_draws_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let done = rpi(
        &[
            "robot", "check", "ur10e", "--poses", "100", "--draw", "arm.svg",
        ],
        folder.path(),
    );
    let shown = text(&done.stdout);
    assert!(done.status.success(), "{}", text(&done.stderr));
    for part in [
        "axes: 6",
        "100 of 100 random poses",
        "jerk (acceleration / 0.05 s)",
    ] {
        assert!(shown.contains(part), "{part}:\n{shown}");
    }
    let drawing = std::fs::read_to_string(folder.path().join("arm.svg"));
    assert!(drawing.expect("drawn").starts_with("<svg"));
    let listed = rpi(&["robot", "list"], folder.path());
    assert!(text(&listed.stdout).lines().any(|line| line == "ur10e"));
}

#[test]
fn errors_of_a_description_are_bad_input() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["arm.urdf", "arm.toml", "no-such-arm"] {
        let done = rpi(&["robot", "check", name], folder.path());
        assert_eq!(done.status.code(), Some(2), "{}", text(&done.stdout));
        assert!(text(&done.stderr).contains(name), "{}", text(&done.stderr));
    }
    let cell = "[devices.arm]\nkind = \"arm\"\nmodel = \"arm.urdf\"\n";
    std::fs::write(folder.path().join("cell.toml"), cell).expect("written");
    std::fs::write(folder.path().join("arm.urdf"), "<robot>\n  <link></robot>").expect("written");
    let done = rpi(&["cell", "check", "cell.toml"], folder.path());
    assert_eq!(done.status.code(), Some(2));
    let shown = text(&done.stderr);
    assert!(
        shown.contains("cell.toml:3:9: arm.urdf:2:9: invalid XML"),
        "{shown}"
    );
}

#[test]
fn schemas_are_printed_as_the_repository_has_them() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../editor-support");
    for topic in ["cell", "robot"] {
        let done = rpi(&[topic, "schema"], &folder);
        assert_eq!(done.status.code(), Some(0));
        let file = folder.join(format!("{topic}.schema.json"));
        let own = std::fs::read_to_string(file).expect("the schema of the repository");
        assert_eq!(text(&done.stdout), own, "run `cargo xtask gen`");
    }
}

/// The example of the paper on several types of arm, by a change of one line in the cell: lines, a corner and takeovers. The
/// device checks all limits of the axes.
#[test]
fn the_blending_example_runs_on_other_arms_by_one_line_of_the_cell() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/blending");
    let read = |name| std::fs::read_to_string(example.join(name)).expect("the example");
    let program = read("blending.rpi").replace("repeat 9 times", "repeat 2 times");
    let cell = read("cell.toml");
    let line = "model = \"kuka-lwr4+\"";
    assert!(cell.contains(line), "{cell}");
    for model in [
        "kuka-lwr4+",
        "kuka-iiwa-7",
        "ur5e",
        "kuka-kr6-r900",
        "franka-panda",
        "franka-fr3",
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let cell = cell.replace(line, &format!("model = \"{model}\""));
        std::fs::write(folder.path().join("cell.toml"), cell).expect("written");
        std::fs::write(folder.path().join("blending.rpi"), &program).expect("written");
        let done = rpi(&["run", "blending.rpi", "--time", "60s"], folder.path());
        let shown = text(&done.stdout) + &text(&done.stderr);
        assert_eq!(done.status.code(), Some(0), "{model}:\n{shown}");
    }
}
