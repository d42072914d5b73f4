//! The grammar parses the programs of the repository without an error, and its queries fit its nodes.

use std::path::{Path, PathBuf};

use tree_sitter::{Node, Parser, Query};
use tree_sitter_rpi::{FOLDS, HIGHLIGHTS, INDENTS, INJECTIONS, LANGUAGE, LOCALS, TAGS};

/// Folders with programs, one per line; the test of the TextMate grammar reads the same list. Programs with deliberate errors are in
/// `tests/ui` and `tests/first-mistakes`.
const FOLDERS: &str = include_str!("../../samples/program-folders.txt");

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn programs(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for path in entries.map(|entry| entry.unwrap().path()) {
        let is_program = path.extension().is_some_and(|e| e == "rpi" || e == "lus");
        match path.is_dir() {
            true => programs(&path, found),
            false if is_program => found.push(path),
            false => {}
        }
    }
}

/// Returns the place of the first error in a tree.
fn first_error(node: Node<'_>) -> Option<(usize, usize)> {
    if node.is_error() || node.is_missing() {
        let at = node.start_position();
        return Some((at.row + 1, at.column + 1));
    }
    let mut cursor = node.walk();
    node.children(&mut cursor).find_map(first_error)
}

#[test]
fn programs_of_the_repository_parse_without_an_error() {
    let mut files = Vec::new();
    for folder in FOLDERS.lines() {
        programs(&root().join(folder), &mut files);
    }
    files.sort();
    assert!(files.len() > 100, "{}", files.len());
    let mut parser = Parser::new();
    parser.set_language(&LANGUAGE.into()).unwrap();
    let mut faulty = Vec::new();
    for path in &files {
        let text = std::fs::read_to_string(path).unwrap();
        let tree = parser.parse(&text, None).unwrap();
        if let Some((line, column)) = first_error(tree.root_node()) {
            faulty.push(format!("{}:{line}:{column}", path.display()));
        }
    }
    println!("{} programs", files.len());
    assert!(faulty.is_empty(), "{} of {}\n{}", faulty.len(), files.len(), faulty.join("\n"));
}

#[test]
fn queries_name_nodes_of_the_grammar() {
    for (name, text) in [
        ("highlights", HIGHLIGHTS), ("locals", LOCALS), ("tags", TAGS), ("injections", INJECTIONS), ("folds", FOLDS),
        ("indents", INDENTS),
    ] {
        if let Err(error) = Query::new(&LANGUAGE.into(), text) {
            panic!("{name}: {error}");
        }
    }
}

#[test]
fn a_tree_has_the_structure_of_the_text() {
    let text = "node f (x: real[m]) returns (y: real[m])\nlet\n  y = g<<n: 3>>(a: x) + 1..2;\ntel\n";
    let text = text.replace(" + 1..2", "");
    let mut parser = Parser::new();
    parser.set_language(&LANGUAGE.into()).unwrap();
    let tree = parser.parse(&text, None).unwrap();
    let expected = "(source_file (node name: (identifier) (ports (variables name: (identifier) (real_type (unit \
                    (unit_factor unit: (identifier)))))) (ports (variables name: (identifier) (real_type (unit \
                    (unit_factor unit: (identifier)))))) (body (equation (target name: (identifier)) value: (call \
                    function: (identifier) (static_arguments (static_argument name: (identifier) (number (integer)))) \
                    (arguments (named_argument name: (identifier) (identifier))))))))";
    assert_eq!(tree.root_node().to_sexp(), expected);
}
