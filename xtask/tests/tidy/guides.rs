//! Paths in `ARCHITECTURE.md`, in `CONTRIBUTING.md` and in the module tables of crates must exist.

use std::path::Path;

use rpi_testkit::workspace_root;
use xtask::source_files;

const GUIDES: &[&str] = &["ARCHITECTURE.md", "CONTRIBUTING.md"];

/// Names in the guides that look like paths but are created by a task, or stand for others.
const NO_FILES: &[&str] = &[
    "../shared",
    "crates/rpi-diag/pages/RPI4007.md",
    "fuzz/targets/target/corpus",
    "fuzz/targets/target/found",
    "target/book",
    "tests/fuzz/ENTRY",
];

#[test]
fn guides_name_paths_that_exist() {
    let mut missing = Vec::new();
    for guide in GUIDES {
        let text = std::fs::read_to_string(workspace_root().join(guide)).unwrap_or_default();
        let spans = text.split('`').skip(1).step_by(2);
        for path in spans.filter(|span| is_path(span)) {
            let file = path.split("::").next().unwrap_or_default();
            let folder = file.split('*').next().unwrap_or_default();
            if !NO_FILES.contains(&file) && !workspace_root().join(folder).exists() {
                missing.push(format!("{guide}: {path}"));
            }
        }
    }
    assert!(missing.is_empty(), "no such path:\n{}", missing.join("\n"));
}

/// A path has a `/` and neither spaces nor characters of code.
fn is_path(span: &str) -> bool {
    let plain = |c: char| c.is_alphanumeric() || "/._-*:".contains(c);
    span.contains('/') && span.chars().all(plain) && !span.contains("://")
}

/// Rows of module tables: `//! | \`file.rs\` | purpose |`.
#[test]
fn module_tables_name_files_that_exist() {
    let mut missing = Vec::new();
    for file in source_files() {
        let folder = file.path.parent().unwrap_or(Path::new(""));
        let rows = file
            .text
            .lines()
            .filter_map(|line| line.strip_prefix("//! | `"));
        let cells = rows.filter_map(|row| row.split('|').next());
        let names = cells.flat_map(|cell| cell.split('`').step_by(2));
        for name in names.filter(|name| name.ends_with(".rs")) {
            if !workspace_root().join(folder).join(name).exists() {
                missing.push(format!("{}: {name}", file.path.display()));
            }
        }
    }
    assert!(
        missing.is_empty(),
        "no such module:\n{}",
        missing.join("\n")
    );
}
