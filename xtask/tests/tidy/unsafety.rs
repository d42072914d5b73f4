//! Rule 7: `unsafe` is forbidden except in the listed crates.

use rpi_testkit::workspace_root;
use xtask::{packages, source_files};

/// Crates that may contain `unsafe` code, with the reason.
const ALLOWED: &[(&str, &str)] = &[];

#[test]
fn the_workspace_forbids_unsafe_and_every_crate_obeys() {
    let manifest = std::fs::read_to_string(workspace_root().join("Cargo.toml")).unwrap_or_default();
    assert!(
        manifest.contains("\nunsafe_code = \"forbid\"\n"),
        "the workspace lint is gone"
    );
    for package in packages().iter().filter(|p| reason(&p.name).is_none()) {
        let manifest = std::fs::read_to_string(package.dir.join("Cargo.toml")).unwrap_or_default();
        let obeys = manifest.contains("[lints]\nworkspace = true");
        assert!(
            obeys,
            "{} does not inherit the lints of the workspace",
            package.name
        );
    }
}

/// All uses of the keyword. It also occurs in quotes, because it is a keyword of Lustre.
const FORMS: &[&str] = &[
    "unsafe {",
    "unsafe fn",
    "unsafe impl",
    "unsafe trait",
    "unsafe extern",
    "(unsafe",
];

#[test]
fn no_file_outside_of_the_table_says_unsafe() {
    for file in source_files()
        .iter()
        .filter(|file| reason(&file.owner).is_none())
    {
        let lines = file
            .text
            .lines()
            .filter(|line| !line.trim_start().starts_with("//"));
        let found = lines
            .into_iter()
            .find(|line| FORMS.iter().any(|form| has_word(line, form)));
        assert_eq!(found, None, "{}", file.path.display());
    }
}

/// Returns whether the form occurs in the line as a separate word.
fn has_word(line: &str, form: &str) -> bool {
    let in_name = |c: char| c.is_alphanumeric() || c == '_';
    line.match_indices(form)
        .any(|(at, _)| !line[..at].ends_with(in_name))
}

fn reason(crate_name: &str) -> Option<&'static str> {
    ALLOWED
        .iter()
        .find(|(name, _)| *name == crate_name)
        .map(|(_, why)| *why)
}
