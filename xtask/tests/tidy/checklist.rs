//! Every row of the checklist in the book must name existing files and tests.

use rpi_testkit::workspace_root;
use xtask::functions;

/// Number of rows.
const ROWS: usize = 38;

#[test]
fn every_promise_names_what_shows_it() {
    let text = std::fs::read_to_string(workspace_root().join("docs/src/checklist.md"));
    let text = text.unwrap_or_default();
    let rows = text
        .lines()
        .filter(|line| line.starts_with("| ") && !line.starts_with("| #"));
    let mut number = 0;
    for row in rows {
        number += 1;
        assert!(
            row.starts_with(&format!("| {number} |")),
            "row {number}: {row}"
        );
        let named: Vec<&str> = row.split('`').skip(1).step_by(2).collect();
        assert!(!named.is_empty(), "promise {number} names nothing");
        named.iter().for_each(|place| exists(number, place));
    }
    assert_eq!(number, ROWS);
}

/// Checks a reference of the form `path/to/file` or `path/to/file.rs::test`.
fn exists(number: usize, place: &str) {
    let (path, test) = match place.split_once("::") {
        Some((path, test)) => (path, Some(test)),
        None => (place, None),
    };
    let text = std::fs::read_to_string(workspace_root().join(path));
    let text = text.unwrap_or_else(|_| panic!("promise {number}: no file {path}"));
    if let Some(test) = test {
        let there = functions(&text).iter().any(|f| f.name == test);
        assert!(there, "promise {number}: {path} has no test `{test}`");
    }
}
