//! Helpers of the tests.

use rpi_diag::{FileId, SourceMap, Style, render};
use rpi_syntax::ast::File;
use rpi_syntax::{Dialect, Parens, Parse, dump_ast, parse};
use std::path::Path;

/// Program of `tests/programs`.
pub(crate) struct Program {
    pub(crate) name: String,
    pub(crate) text: String,
    pub(crate) mode: Dialect,
}

/// Returns all programs of `tests/programs`, sorted by name.
pub(crate) fn programs() -> Vec<Program> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/programs");
    let files = std::fs::read_dir(folder).expect("the folder is part of the crate");
    let mut paths: Vec<_> = files.map(|file| file.expect("readable").path()).collect();
    paths.sort();
    let program = |path: &std::path::PathBuf| {
        let name = path
            .file_name()
            .and_then(|name| name.to_str())
            .unwrap_or_default();
        Program {
            name: name.to_owned(),
            text: std::fs::read_to_string(path).expect("programs are UTF-8"),
            mode: Dialect::from_path(name),
        }
    };
    paths.iter().map(program).collect()
}

/// Parses a text without errors. Panics with the rendered errors if there are any.
#[track_caller]
pub(crate) fn parse_clean(text: &str, mode: Dialect) -> Parse {
    let parsed = parse(FileId(0), text, mode);
    let errors: Vec<_> = parsed
        .diagnostics
        .iter()
        .filter(|diagnostic| diagnostic.severity() == rpi_diag::Severity::Error)
        .cloned()
        .collect();
    if !errors.is_empty() {
        let mut sources = SourceMap::new();
        sources.add("text", text);
        panic!("{}\n{text}", render(&errors, &sources, Style::PLAIN));
    }
    parsed
}

/// Dumps a tree with the parentheses of the source.
pub(crate) fn dump_with_parens(file: &File) -> String {
    dump_ast(file, Parens::Keep)
}

/// Dumps a tree without the parentheses of the source.
pub(crate) fn dump_without_parens(file: &File) -> String {
    dump_ast(file, Parens::Drop)
}

/// Returns each comment with the tokens before and after it. Tokens in `passed` are ignored.
pub(crate) fn comments(
    text: &str,
    parsed: &Parse,
    passed: &[&str],
) -> Vec<(String, String, String)> {
    let mut found = Vec::new();
    let (mut before, mut reached, mut waiting) = (String::new(), 0, 0);
    for comment in &parsed.comments.all {
        let [start, end] = [comment.span.start, comment.span.end].map(|at| at as usize);
        note_neighbours(
            &mut found,
            &mut waiting,
            &mut before,
            &words(&text[reached..start], passed),
        );
        let written = text[start..end].trim_end().to_owned();
        found.push((written, before.clone(), String::new()));
        reached = end;
    }
    note_neighbours(
        &mut found,
        &mut waiting,
        &mut before,
        &words(&text[reached..], passed),
    );
    found
}

/// Stores the first word as the token after the waiting comments, and the last as the token before the next ones.
fn note_neighbours(
    found: &mut [(String, String, String)],
    waiting: &mut usize,
    before: &mut String,
    words: &[String],
) {
    let [Some(first), Some(last)] = [words.first(), words.last()] else {
        return;
    };
    for (_, _, behind) in &mut found[*waiting..] {
        behind.clone_from(first);
    }
    *waiting = found.len();
    before.clone_from(last);
}

/// Splits a text into words and single symbols, without those in `left_out`.
fn words(text: &str, left_out: &[&str]) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let is_word = |c: char| c.is_alphanumeric() || "_'".contains(c);
    let mut in_word = false;
    for c in text.chars() {
        match words.last_mut() {
            Some(word) if in_word && is_word(c) => word.push(c),
            _ if c.is_whitespace() => {}
            _ => words.push(c.into()),
        }
        in_word = is_word(c);
    }
    words.retain(|word| !left_out.contains(&word.as_str()));
    words
}

/// Asserts that two texts are equal. Panics with the first line that differs.
#[track_caller]
pub(crate) fn assert_same(left: &str, right: &str, what: &str) {
    let differs = |(_, (a, b)): &(usize, (&str, &str))| a != b;
    let pairs = left.lines().chain([""]).zip(right.lines().chain([""]));
    if let Some((line, (a, b))) = pairs.enumerate().find(differs) {
        panic!(
            "{what}, from line {}:\n  {a}\n  {b}\n--- in\n{left}\n--- and\n{right}",
            line + 1
        );
    }
    assert_eq!(
        left.len(),
        right.len(),
        "{what}: one goes on\n{left}\n---\n{right}"
    );
}
