//! `rpi why` on programs with a known cause. Each file `tests/why/NAME.rpi` begins with the question, and the exit status of the run if it is
//! not 0; `NAME.txt` is the answer, and `NAME.toml` the cell if the program has one.
//! `RPI_BLESS=1` writes the answers.

mod support;

use std::path::{Path, PathBuf};
use support::rpi_texts;

/// Returns a path below the root of the project.
fn below_root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path)
}

fn programs() -> Vec<PathBuf> {
    let files = std::fs::read_dir(below_root("tests/why"))
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = files
        .filter(|file| file.extension().is_some_and(|end| end == "rpi"))
        .collect();
    files.sort();
    files
}

#[test]
fn the_slice_names_the_cause_and_nothing_beside_it() {
    let programs = programs();
    assert!(programs.len() >= 20);
    for program in programs {
        let text = std::fs::read_to_string(&program).unwrap();
        let question = text
            .lines()
            .next()
            .and_then(|line| line.strip_prefix("--| why "));
        let flow = question.unwrap_or_else(|| panic!("{} asks nothing", program.display()));
        let recorded = tempfile::tempdir().unwrap();
        let file = recorded.path().join("run.mcap");
        let (name, file) = (program.to_str().unwrap(), file.to_str().unwrap());
        let exit = text
            .lines()
            .nth(1)
            .and_then(|line| line.strip_prefix("--| exit "));
        let exit = exit.map_or(0, |status| status.parse().unwrap());
        let cell = program.with_extension("toml");
        let mut arguments = vec!["run", name, "--record", file];
        if cell.exists() {
            arguments.extend(["--cell", cell.to_str().unwrap()]);
        }
        let (status, _, message) = rpi_texts(&arguments);
        assert_eq!(status, exit, "{name}: {message}");
        let (status, answer, message) = rpi_texts(&["why", file, flow]);
        assert_eq!(status, 0, "{name}: {message}");
        let answer: String = answer
            .lines()
            .map(|line| format!("{}\n", line.trim_end()))
            .collect();
        let expected = program.with_extension("txt");
        if std::env::var_os("RPI_BLESS").is_some() {
            std::fs::write(&expected, &answer).unwrap();
        }
        let expected = std::fs::read_to_string(&expected).unwrap_or_default();
        assert_eq!(answer, expected, "{name}");
    }
}

/// The library reads sensors that an optimised command does not need, and calls functions of the arm.
#[test]
fn motions_of_arms_are_explained() {
    let recorded = tempfile::tempdir().unwrap();
    let file = recorded.path().join("run.mcap");
    let file = file.to_str().unwrap();
    let program = below_root("examples/lifting/lifting.rpi");
    let (status, _, message) = rpi_texts(&["run", program.to_str().unwrap(), "--record", file]);
    assert_eq!(status, 0, "{message}");
    let (status, answer, message) = rpi_texts(&["why", file, "Over.way.done"]);
    assert!(
        status == 0 && answer.starts_with("way.done = true at "),
        "{answer}{message}"
    );
    let (status, table, message) = rpi_texts(&[
        "export",
        file,
        "--watch",
        "Over.way",
        "--column",
        "/command/Over",
    ]);
    assert!(
        status == 0 && table.contains("/command/Over/way.travelled"),
        "{message}"
    );
}

#[test]
fn a_question_without_one_value_is_refused_with_a_way_out() {
    let recorded = tempfile::tempdir().unwrap();
    let file = recorded.path().join("run.mcap");
    let file = file.to_str().unwrap();
    let program = below_root("tests/why/through-a-call.rpi");
    let (status, _, message) = rpi_texts(&["run", program.to_str().unwrap(), "--record", file]);
    assert_eq!(status, 0, "{message}");
    let (status, _, message) = rpi_texts(&["why", file, "Main.alram"]);
    assert!(
        status == 2 && message.contains("did you mean `Main.alarm`"),
        "{message}"
    );
    let (status, _, message) = rpi_texts(&["why", file, "Main"]);
    assert!(
        status == 2 && message.contains("`Main` is the name of a command"),
        "{message}"
    );
    let (status, _, message) = rpi_texts(&["why", file, "Main.alarm", "--at", "3600s"]);
    assert_eq!(status, 0, "the last cycle counts: {message}");
}
