//! `rpic new`: the project that it creates has no diagnostic, is formatted, and passes its test.

use std::path::Path;
use std::process::{Command, Output};

fn rpic(args: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rpic"))
        .args(args)
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .output()
        .unwrap()
}

#[test]
fn a_new_project_checks_tests_and_is_formatted() {
    let folder = tempfile::tempdir().unwrap();
    let made = rpic(&["new", "pick cell"], folder.path());
    assert!(made.status.success(), "{made:?}");
    let project = folder.path().join("pick cell");
    for args in [
        &["check"][..],
        &["check", "."],
        &["fmt", "--check"],
        &["test"],
        &["test", "."],
        &["doc"],
    ] {
        let output = rpic(args, &project);
        assert!(output.status.success(), "{args:?}: {output:?}");
    }
    let manifest = std::fs::read_to_string(project.join("rpi.toml")).unwrap();
    assert!(manifest.contains("name = \"pick cell\""), "{manifest}");
    let cell = std::fs::read_to_string(project.join("cell.toml")).unwrap();
    let schema = cell
        .lines()
        .next()
        .and_then(|line| line.strip_prefix("#:schema "));
    let schema = std::fs::read_to_string(project.join(schema.expect("a schema"))).unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let own = std::fs::read_to_string(root.join("editor-support/cell.schema.json")).unwrap();
    assert_eq!(schema, own);
}

#[test]
fn a_folder_with_files_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("main.rpi"), "mine").unwrap();
    let output = rpic(&["new", "."], folder.path());
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let output = rpic(&["new", folder.path().to_str().unwrap()], folder.path());
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let text = std::fs::read_to_string(folder.path().join("main.rpi")).unwrap();
    assert_eq!(text, "mine");
    assert_eq!(folder.path().read_dir().unwrap().count(), 1);
}
