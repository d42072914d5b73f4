//! Checks the examples in documents: files are written, commands are run, and their output must be as shown.
//!
//! A block `rpi lamp.rpi` also creates a file of that name, for later commands in the same document; `rpi,wrong
//! slip.rpi` creates one with an error. A block `console` has lines `$ command`, each followed by its output (standard
//! output, then standard error); a line `...` matches any number of lines. `cargo xtask bless book` updates the outputs.

use std::path::{Path, PathBuf};
use std::process::Command;

use rpi_sim::Cell;
use rpi_testkit::{files_below, workspace_root};
use xtask::{Fence, fences};

/// Kind of check for the blocks of a language.
#[derive(Clone, Copy, PartialEq)]
enum BlockKind {
    /// Compiled without diagnostics, checked in `docs.rs`.
    Compiled,
    /// Written to files that commands in the document use.
    Written,
    /// Run, and the output compared.
    Run,
    /// Parsed as cell descriptions.
    Cell,
    /// Not checked: figures, formats, and settings and commands of other tools.
    Unchecked,
}

const LANGUAGES: &[(&str, BlockKind)] = &[
    ("rpi", BlockKind::Compiled),
    ("rpi,wrong", BlockKind::Written),
    ("lus", BlockKind::Compiled),
    ("rpinet", BlockKind::Compiled),
    ("csv", BlockKind::Written),
    ("console", BlockKind::Run),
    ("toml", BlockKind::Cell),
    ("json", BlockKind::Unchecked),
    ("sh", BlockKind::Unchecked),
    ("text", BlockKind::Unchecked),
    ("lua", BlockKind::Unchecked),
    ("python", BlockKind::Unchecked),
    ("krl", BlockKind::Unchecked),
    ("rapid", BlockKind::Unchecked),
    ("urscript", BlockKind::Unchecked),
    ("", BlockKind::Unchecked),
];

/// Documents whose TOML blocks are settings of an editor, not cell descriptions.
const OTHER_TOML: &[&str] = &["docs/src/points.md", "editor-support/README.md"];

#[test]
fn every_block_is_of_a_kind_that_is_held() {
    for (path, fence) in all_fences() {
        let language = language(&fence);
        let known = LANGUAGES.iter().any(|(name, _)| *name == language);
        let on_page = language.starts_with("rpi-wrong") || language.starts_with("rpi-right");
        let place = format!("{}:{}", path.display(), fence.line);
        assert!(
            known || on_page,
            "{place}: unknown block language `{language}`"
        );
    }
}

#[test]
fn cells_in_documents_are_right() {
    let mut count = 0;
    for (path, fence) in all_fences() {
        let place = format!("{}:{}", path.display(), fence.line);
        let other = OTHER_TOML.iter().any(|other| path.ends_with(other));
        if block_kind(&fence) == Some(BlockKind::Cell) && !other {
            count += 1;
            let read = Cell::parse(&place, &fence.code);
            assert!(read.is_ok(), "{place}: {:?}", read.err());
        }
    }
    assert!(count > 0, "no document shows a cell");
}

#[test]
fn commands_in_documents_print_what_is_shown() {
    let bless = std::env::var_os("RPI_BLESS").is_some();
    let (mut count, mut wrong) = (0, Vec::new());
    for path in documents() {
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        let dir = tempfile::tempdir().expect("a folder can be made");
        let mut now = text.clone();
        for fence in fences(&text) {
            if let Some(name) = fence.info.split(' ').nth(1) {
                std::fs::write(dir.path().join(name), &fence.code).expect("it can be written");
            }
            if block_kind(&fence) != Some(BlockKind::Run) {
                continue;
            }
            for (command, shown) in commands(&fence.code) {
                count += 1;
                let printed = run_command(&command, dir.path());
                if !matches(&shown, &printed) {
                    now = now.replacen(&block(&command, &shown), &block(&command, &printed), 1);
                    let place = format!("{}:{}", path.display(), fence.line);
                    wrong.push(format!(
                        "{place}: $ {command}\n{printed}--- but the document shows\n{shown}"
                    ));
                }
            }
        }
        if bless && now != text {
            std::fs::write(&path, now).expect("documents can be written");
        }
    }
    assert!(count > 10, "only {count} commands in documents");
    assert!(bless || wrong.is_empty(), "{}", wrong.join("\n"));
}

fn block(command: &str, output: &str) -> String {
    format!("$ {command}\n{output}")
}

/// Returns the commands of a block, each with its documented output.
fn commands(code: &str) -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> = Vec::new();
    for line in code.lines() {
        match (line.strip_prefix("$ "), found.last_mut()) {
            (Some(command), _) => found.push((command.to_owned(), String::new())),
            (None, Some((_, output))) => output.extend([line, "\n"]),
            (None, None) => panic!("output without a command: {line}"),
        }
    }
    found
}

/// Returns the output of a command that is run in a folder.
fn run_command(command: &str, dir: &Path) -> String {
    let mut words = command.split(' ');
    let tool = words.next().unwrap_or_default();
    let args: Vec<&str> = words.collect();
    if tool == "cat" {
        let files = args
            .iter()
            .map(|file| std::fs::read_to_string(dir.join(file)));
        return files
            .map(|text| text.unwrap_or_else(|e| e.to_string()))
            .collect();
    }
    let output = Command::new(self::tool(tool))
        .args(args)
        .current_dir(dir)
        .env("NO_COLOR", "1")
        .env_remove("CI")
        .output();
    let output = output.unwrap_or_else(|e| panic!("{tool}: {e}; build `rpic` and `rpi` first"));
    let all = [output.stdout, output.stderr].concat();
    String::from_utf8_lossy(&all).into_owned()
}

/// Returns the path of a tool: cargo puts it beside the tests when the whole workspace is tested.
fn tool(name: &str) -> PathBuf {
    assert!(["rpi", "rpic"].contains(&name), "no document runs `{name}`");
    let test = std::env::current_exe().expect("a test has a path");
    let target = test
        .parent()
        .and_then(Path::parent)
        .expect("it lies in target/*/deps");
    target
        .join(name)
        .with_extension(std::env::consts::EXE_EXTENSION)
}

/// Returns whether an output is as documented; `...` matches any number of lines.
fn matches(shown: &str, printed: &str) -> bool {
    let shown: Vec<&str> = shown.lines().map(str::trim_end).collect();
    let printed: Vec<&str> = printed.lines().map(str::trim_end).collect();
    lines_match(&shown, &printed)
}

fn lines_match(shown: &[&str], printed: &[&str]) -> bool {
    match shown.split_first() {
        None => printed.is_empty(),
        Some((&"...", rest)) => (0..=printed.len()).any(|k| lines_match(rest, &printed[k..])),
        Some((first, rest)) => {
            let same = printed.first() == Some(first);
            same && lines_match(rest, &printed[1..])
        }
    }
}

#[test]
fn dots_stand_for_any_lines() {
    assert!(matches("a\n...\nd\n", "a\nb\nc\nd\n"));
    assert!(matches("...\n", ""));
    assert!(!matches("a\n", "a\nb\n"));
    assert!(!matches("...\nb\n", "b\na\n"));
}

fn language(fence: &Fence) -> &str {
    fence.info.split(' ').next().unwrap_or_default()
}

fn block_kind(fence: &Fence) -> Option<BlockKind> {
    let found = LANGUAGES.iter().find(|(name, _)| *name == language(fence));
    found.map(|(_, held)| *held)
}

fn all_fences() -> Vec<(PathBuf, Fence)> {
    let in_file = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        fences(&text)
            .into_iter()
            .map(move |fence| (path.clone(), fence))
    };
    documents().into_iter().flat_map(in_file).collect()
}

/// Returns all documents: at the root, in the book, beside programs and clients.
fn documents() -> Vec<PathBuf> {
    let generated = workspace_root().join("docs/src/findings.md");
    files_below("", &[".md"])
        .into_iter()
        .filter(|path| !path.to_string_lossy().contains("/pages/") && *path != generated)
        .collect()
}
