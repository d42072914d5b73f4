//! Diagnostics of programs with syntax errors.
//!
//! Each file of `tests/broken` ends with comments that list its expected diagnostics. `cargo xtask bless syntax` rewrites them.

use rpi_diag::{Code, Diagnostic, FileId, SourceMap};
use rpi_syntax::ast::{ItemKind, StatementKind};
use rpi_syntax::{Dialect, format, parse};
use std::path::{Path, PathBuf};

const EXPECTED_MARK: &str = "\n-- found:\n";

#[test]
fn faults_are_found_once_and_in_place() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/broken");
    let files = std::fs::read_dir(folder).expect("the folder is part of the crate");
    let mut paths: Vec<PathBuf> = files.map(|file| file.expect("readable").path()).collect();
    paths.sort();
    let wrong: Vec<String> = paths.iter().filter_map(|path| check(path)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Compares the expected and actual diagnostics of a file. Returns a description of the difference.
fn check(path: &Path) -> Option<String> {
    let text = std::fs::read_to_string(path).expect("programs are UTF-8");
    let (program, says) = text.split_once(EXPECTED_MARK).unwrap_or((&text, ""));
    let program = format!("{}\n", program.trim_end());
    let found = diagnostics_text(&program, Dialect::from_path(&path.to_string_lossy()));
    if std::env::var_os("RPI_BLESS").is_some() {
        std::fs::write(path, format!("{program}{EXPECTED_MARK}{found}")).expect("writable");
    }
    let differs = format!("{}\n--- says\n{says}--- but\n{found}", path.display());
    (says != found).then_some(differs)
}

fn diagnostics_text(program: &str, mode: Dialect) -> String {
    let mut sources = SourceMap::new();
    let file = sources.add("text", program);
    let line = |diagnostic: &Diagnostic| {
        let place = sources.line_col(diagnostic.span());
        format!("-- {place} {} {}\n", diagnostic.code, diagnostic.message)
    };
    parse(file, program, mode)
        .diagnostics
        .iter()
        .map(line)
        .collect()
}

/// Returns the names that the tree of a text declares, including those in error nodes.
fn declared(text: &str) -> Vec<String> {
    let file = parse(FileId(0), text, Dialect::Rpi).file;
    let names = |kind: &ItemKind| match kind {
        ItemKind::Node(node) => vec![node.signature.name.name.to_string()],
        ItemKind::Command(command) => vec![command.name.name.to_string()],
        ItemKind::Const(defs) => {
            let names = defs.iter().flat_map(|def| &def.names);
            names.map(|name| name.name.to_string()).collect()
        }
        ItemKind::Error(declared) => declared
            .iter()
            .map(|d| format!("{:?} {}", d.kind, d.name.name))
            .collect(),
        _ => Vec::new(),
    };
    file.items
        .iter()
        .flat_map(|item| names(&item.kind))
        .collect()
}

#[test]
fn broken_declarations_still_declare() {
    assert_eq!(
        declared("node A x: real) let y = x; tel node B () returns (y: int) let y = 1; tel"),
        ["Callable A", "B"]
    );
    assert_eq!(declared("comand C (arm: Arm) let tel"), ["C"]);
    assert_eq!(
        declared("const a = ; b = 2; c, d: = 3;"),
        ["a", "b", "c", "d"]
    );
    assert_eq!(
        declared("frame a, b in in c; device D sensor; task T;"),
        ["Frame a", "Frame b", "Device D", "Task T"]
    );
    assert_eq!(declared("command C (arm: Arm) let x = 1 +"), ["C"]);
}

#[test]
fn broken_statements_still_define() {
    let text = "node A () returns (x: int) let x, a.b = 1 +; (y, z) = ; finish r when; fragment F when let q = 1; tel tel";
    let file = parse(FileId(0), text, Dialect::Rpi).file;
    let ItemKind::Node(node) = &file.items[0].kind else {
        panic!("{file:?}");
    };
    let rpi_syntax::ast::NodeDef::Body(body) = &node.definition else {
        panic!("{node:?}");
    };
    let names = body
        .statements
        .iter()
        .filter_map(|statement| match &statement.kind {
            StatementKind::Error(names) => Some(
                names
                    .iter()
                    .map(|name| name.name.as_str())
                    .collect::<Vec<_>>(),
            ),
            _ => None,
        });
    assert_eq!(
        names.collect::<Vec<_>>(),
        [vec!["x", "a"], vec!["y", "z"], vec!["r"], vec!["F"]]
    );
}

#[test]
fn deep_nesting_is_refused_before_it_hurts() {
    let deep = |n: usize| format!("const x = {}1{};", "(".repeat(n), ")".repeat(n));
    assert!(
        parse(FileId(0), &deep(400), Dialect::Rpi)
            .diagnostics
            .is_empty()
    );
    for text in [
        deep(100_000),
        format!("const x = {}1;", "- ".repeat(100_000)),
        format!("const x = 1{};", " -> 1".repeat(100_000)),
        format!("const x = a{};", "[0]".repeat(100_000)),
        format!("const x = a{};", ".b".repeat(100_000)),
        format!("const x: int{};", "^2".repeat(100_000)),
        format!("const x = {}1;", "if a then b else ".repeat(100_000)),
        format!("node f () returns () {}", "let fragment a ".repeat(100_000)),
        "<<".repeat(100_000),
        "node f <<".repeat(10_000),
    ] {
        let parsed = parse(FileId(0), &text, Dialect::Rpi);
        assert!(!parsed.diagnostics.is_empty());
    }
}

/// Each of these operators can be chained without brackets, so every repetition must count as a nesting level.
#[test]
fn every_operator_of_lustre_counts_as_a_level() {
    for (before, behind) in [
        ("forall (a: int) ", ""),
        ("exists (a: int) ", ""),
        ("! ", ""),
        ("", " lsh 1"),
        ("", " rsh 1"),
        ("", " && 1"),
        ("", " || 1"),
        ("", " % 1"),
        ("", " | 1"),
    ] {
        let [before, behind] = [before, behind].map(|text| text.repeat(50_000));
        let text = format!("node f () returns (x: int); let x = {before}1{behind}; tel");
        let found = parse(FileId(0), &text, Dialect::Lustre).diagnostics;
        assert!(
            found.iter().any(|f| f.code == Code::RPI0011),
            "{before:.20} {behind:.20}: {found:?}"
        );
        assert!(format(&text, Dialect::Lustre).is_err());
    }
}

#[test]
fn many_faults_take_no_longer_than_one_by_one() {
    let body = "  x = 1 +;\n".repeat(5_000);
    let text = format!("node A () returns (x: int)\nlet\n{body}tel\n");
    let start = std::time::Instant::now();
    let found = parse(FileId(0), &text, Dialect::Rpi).diagnostics.len();
    assert!(found >= 20, "{found}");
    assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
}
