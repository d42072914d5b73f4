//! Size limits that keep the code readable: short functions, files with one topic, and modules with a description.

use xtask::{functions, source_files};

/// Number of lines above which a function must be listed in [`LONG`] with a reason.
const LONG_FUNCTION: usize = 60;
/// Number of lines, without unit tests, above which a file must be listed in [`LONG`] with a reason.
const LONG_FILE: usize = 600;

/// Functions and files that may be longer, with the reason: a file, or `file::function`.
const LONG: &[(&str, &str)] = &[];

#[test]
fn functions_are_short() {
    let mut lengths: Vec<usize> = Vec::new();
    let mut long: Vec<String> = Vec::new();
    for file in source_files() {
        for function in functions(file.without_tests()) {
            lengths.push(function.lines);
            let name = format!("{}::{}", file.path.display(), function.name);
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
        "functions that are too long:\n{}",
        long.join("\n")
    );
}

#[test]
fn files_hold_one_idea() {
    let mut long: Vec<String> = Vec::new();
    for file in source_files() {
        let (name, lines) = (
            file.path.display().to_string(),
            file.without_tests().lines().count(),
        );
        if lines > LONG_FILE && !has_reason(&name) {
            long.push(format!("{name}: {lines} lines"));
        }
    }
    assert!(
        long.is_empty(),
        "files that are too long:\n{}",
        long.join("\n")
    );
}

#[test]
fn modules_say_what_they_are_for() {
    let files = source_files();
    let silent: Vec<_> = files
        .iter()
        .filter(|f| !f.text.starts_with("//!"))
        .map(|f| &f.path)
        .collect();
    assert!(
        silent.is_empty(),
        "modules without a `//!` comment: {silent:?}"
    );
}

fn has_reason(name: &str) -> bool {
    LONG.iter().any(|(known, _)| *known == name)
}
