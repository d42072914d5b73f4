//! Tests of the formatter: it keeps the tree and the comments, and it is idempotent.

use crate::support::{
    assert_same, comments, dump_with_parens, dump_without_parens, parse_clean, programs,
};
use rpi_syntax::{Dialect, format, print};
use std::path::Path;

#[track_caller]
fn formatted(text: &str, mode: Dialect) -> String {
    format(text, mode).unwrap_or_else(|_| panic!("has errors:\n{text}"))
}

/// Checks the properties of the formatter for a text without errors.
#[track_caller]
pub(crate) fn check(text: &str, mode: Dialect) {
    check_beside(text, mode, &[",", ";"]);
}

/// Checks the properties of the formatter. Comments may move past the tokens in `passed`.
#[track_caller]
pub(crate) fn check_beside(text: &str, mode: Dialect, passed: &[&str]) {
    let before = parse_clean(text, mode);
    let once = formatted(text, mode);
    let after = parse_clean(&once, mode);
    assert_same(
        &dump_with_parens(&before.file),
        &dump_with_parens(&after.file),
        &format!("in\n{text}\n---\n{once}\nthe tree changes"),
    );
    // A property in a block comment becomes a line comment, and comments within it are moved before it.
    let moves = text.contains("(*%PROPERTY");
    let list = |comments: Vec<(String, String, String)>| {
        let shown = comments
            .into_iter()
            .map(|(comment, before, behind)| match moves {
                true => comment,
                false => format!("{comment} between `{before}` and `{behind}`"),
            });
        shown.collect::<Vec<_>>().join("\n")
    };
    assert_same(
        &list(comments(text, &before, passed)),
        &list(comments(&once, &after, passed)),
        &format!("in\n{text}\n---\n{once}\ncomments change or move"),
    );
    assert_same(
        &once,
        &formatted(&once, mode),
        "formatting again changes something",
    );
    for line in once.lines() {
        assert_eq!(line, line.trim_end(), "space at the end of a line:\n{once}");
    }
}

#[test]
fn programs_keep_tree_and_comments() {
    for program in programs() {
        println!("{}", program.name);
        check(&program.text, program.mode);
    }
}

#[test]
fn trees_without_text_read_back() {
    for program in programs() {
        println!("{}", program.name);
        let tree = parse_clean(&program.text, program.mode).file;
        let text = print(&tree, program.mode);
        let again = parse_clean(&text, program.mode).file;
        assert_same(
            &dump_without_parens(&tree),
            &dump_without_parens(&again),
            "the tree changes",
        );
        assert_same(
            &text,
            &formatted(&text, program.mode),
            "printed text is not formatted",
        );
    }
}

/// Formatting a program of `tests/unformatted` gives the program of the same name in `tests/formatted`.
#[test]
fn programs_become_formatted_ones() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/unformatted");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("it can be listed").path();
        println!("{}", path.display());
        let read = |path: &Path| std::fs::read_to_string(path).expect("it is UTF-8");
        let name = path.file_name().unwrap_or_default();
        let wanted = read(&Path::new(folder).with_file_name("formatted").join(name));
        let mode = Dialect::from_path(&path.display().to_string());
        assert_same(
            &wanted,
            &formatted(&read(&path), mode),
            "it becomes another",
        );
        count += 1;
    }
    assert!(count > 0);
}

/// Formatting does not change the programs of `tests/formatted`.
#[test]
fn formatted_programs_stay_as_they_are() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/formatted");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("it can be listed").path();
        let text = std::fs::read_to_string(&path).expect("it is UTF-8");
        let mode = Dialect::from_path(&path.display().to_string());
        assert_same(&text, &formatted(&text, mode), "formatting changes it");
        count += 1;
    }
    assert!(count > 0);
}

#[test]
fn texts_without_declarations_begin_with_what_they_hold() {
    for (text, wanted) in [
        ("", ""),
        ("\n\n  \n", ""),
        ("-- only", "-- only\n"),
        ("\n-- only\n\n\n(* two *)\n", "-- only\n\n(* two *)\n"),
        ("--| only\n", "--| only\n"),
    ] {
        assert_eq!(formatted(text, Dialect::Rpi), wanted);
        assert_eq!(formatted(wanted, Dialect::Rpi), wanted);
    }
}

#[test]
fn lines_end_as_most_of_them_do() {
    for program in programs() {
        let plain = formatted(&program.text, program.mode);
        let ends = plain.matches('\n').count();
        let all = plain.replace('\n', "\r\n");
        assert_eq!(formatted(&all, program.mode), all, "{}", program.name);
        let most = all.replacen("\r\n", "\n", ends / 3);
        assert_eq!(formatted(&most, program.mode), all, "{}", program.name);
        let few = plain.replacen('\n', "\r\n", ends / 3);
        assert_eq!(formatted(&few, program.mode), plain, "{}", program.name);
    }
}

#[test]
fn faults_stand_where_they_are_in_lines_that_end_in_another_way() {
    let text = "-- one\r\n(* two\r\n *)\r\nconst n: int = ;\r\n";
    let faults = format(text, Dialect::Rpi).expect_err("a value is missing");
    let at = faults[0].span();
    assert_eq!(text.get(at.start as usize..at.end as usize), Some(";"));
}
