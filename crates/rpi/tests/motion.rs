//! Motions of arms as a user runs them: each folder of `tests/motion` holds a program, its cell and the expected ends of
//! its commands. All limits of the arms are watched.

use std::path::{Path, PathBuf};

mod support;
use support::expected_runs::{assert_run, expected_runs};

fn folders() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/motion");
    let entries = std::fs::read_dir(root).unwrap();
    let mut folders: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    folders.sort();
    folders
}

fn program(folder: &Path) -> PathBuf {
    let files = std::fs::read_dir(folder).unwrap();
    let mut files = files.map(|entry| entry.unwrap().path());
    let is_program = |file: &PathBuf| file.extension().is_some_and(|end| end == "rpi");
    files.find(is_program).expect("a program")
}

#[test]
fn motions_end_as_expected() {
    for folder in folders() {
        let program = program(&folder);
        for run in expected_runs(&folder.join("expected.json")) {
            assert_run(&program, &run);
        }
    }
}
