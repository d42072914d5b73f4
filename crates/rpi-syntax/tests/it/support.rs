//! What the tests share.

use rpi_diag::{FileId, SourceMap, Style, render};
use rpi_syntax::ast::File;
use rpi_syntax::{Mode, Parens, Parse, dump_ast, parse};
use std::path::Path;

/// A program of `tests/programs`.
pub(crate) struct Program {
    pub(crate) name: String,
    pub(crate) text: String,
    pub(crate) mode: Mode,
}

/// All programs of `tests/programs`, by name.
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
            mode: Mode::of_path(name),
        }
    };
    paths.iter().map(program).collect()
}

/// The tree of a text without errors; shows them if there are any.
#[track_caller]
pub(crate) fn parse_clean(text: &str, mode: Mode) -> Parse {
    let parsed = parse(FileId(0), text, mode);
    let errors: Vec<_> = parsed
        .findings
        .iter()
        .filter(|finding| finding.severity() == rpi_diag::Severity::Error)
        .cloned()
        .collect();
    if !errors.is_empty() {
        let mut sources = SourceMap::new();
        sources.add("text", text);
        panic!("{}\n{text}", render(&errors, &sources, Style::PLAIN));
    }
    parsed
}

/// The tree as text, with the writer's parentheses.
pub(crate) fn exact(file: &File) -> String {
    dump_ast(file, Parens::Keep)
}

/// The tree as text, without the writer's parentheses.
pub(crate) fn meaning(file: &File) -> String {
    dump_ast(file, Parens::Drop)
}

/// Each comment with the words or signs that stand before and behind it; those it may pass over are left out.
pub(crate) fn comments(
    text: &str,
    parsed: &Parse,
    passed: &[&str],
) -> Vec<(String, String, String)> {
    let mut found = Vec::new();
    let (mut before, mut reached, mut waiting) = (String::new(), 0, 0);
    for comment in &parsed.comments.all {
        let [start, end] = [comment.span.start, comment.span.end].map(|at| at as usize);
        settle(
            &mut found,
            &mut waiting,
            &mut before,
            &words(&text[reached..start], passed),
        );
        let written = text[start..end].trim_end().to_owned();
        found.push((written, before.clone(), String::new()));
        reached = end;
    }
    settle(
        &mut found,
        &mut waiting,
        &mut before,
        &words(&text[reached..], passed),
    );
    found
}

/// Notes the first of the words behind the comments that wait for one, and the last before those to come.
fn settle(
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

/// The words and signs of a text.
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

/// Compares two texts line by line, and shows the first difference.
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
