//! Habits that keep the code readable: short functions, files of one idea, modules that say what they
//! are for.

use std::path::PathBuf;

use rpi_house::{functions, source_files, without_tests};

/// Lines of a function from which on it must say in [`LONG`] why it is long.
const LONG_FUNCTION: usize = 50;
/// Lines of a file, unit tests apart, from which on it must say in [`LONG`] why it is long.
const LONG_FILE: usize = 450;

/// What may be longer, and why: a file, or `file::function`.
const LONG: &[(&str, &str)] = &[];

#[test]
fn functions_are_short() {
    let mut lengths: Vec<usize> = Vec::new();
    let mut long: Vec<String> = Vec::new();
    for (path, text) in source_files() {
        for function in functions(without_tests(&text)) {
            lengths.push(function.lines);
            let name = format!("{}::{}", path.display(), function.name);
            if function.lines > LONG_FUNCTION && !has_reason(&name) {
                long.push(format!("{name}: {} lines", function.lines));
            }
        }
    }
    lengths.sort_unstable();
    let median = lengths[lengths.len() / 2];
    assert!(
        median <= 10,
        "half of all functions have more than {median} lines"
    );
    assert!(
        long.is_empty(),
        "which table hides in these?\n{}",
        long.join("\n")
    );
}

#[test]
fn files_hold_one_idea() {
    let sizes = source_files()
        .into_iter()
        .map(|(path, text)| (path, without_tests(&text).lines().count()));
    let long: Vec<(PathBuf, usize)> = sizes
        .filter(|(path, lines)| *lines > LONG_FILE && !has_reason(&path.display().to_string()))
        .collect();
    assert!(long.is_empty(), "how many ideas are in these? {long:?}");
}

#[test]
fn modules_say_what_they_are_for() {
    let silent: Vec<PathBuf> = source_files()
        .into_iter()
        .filter(|(_, text)| !text.starts_with("//!"))
        .map(|(path, _)| path)
        .collect();
    assert!(
        silent.is_empty(),
        "no words about what these are for: {silent:?}"
    );
}

fn has_reason(name: &str) -> bool {
    LONG.iter().any(|(known, _)| *known == name)
}
