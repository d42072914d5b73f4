//! Diagnostics as users see them: each program in `tests/ui` must give exactly the messages in the file beside it.
//!
//! After a change, `cargo xtask bless ui` updates the files; review them before committing.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use rpi_diag::{Code, Style, render};
use rpi_testkit::{compare_with_expected, files_below, workspace_root};

use crate::codes::NO_PROGRAM;
use crate::compile::{CheckOutput, check};

/// Time limit. A check of a page of text takes microseconds; one that takes this long hangs.
const HANG: Duration = Duration::from_secs(30);

const PROGRAMS: &[&str] = &[".rpi", ".lus", ".rpinet"];

/// Folders of `tests/ui` whose programs pass the check; the tests of the tools run them.
const RUN_BY_TOOLS: &[&str] = &["emitting", "emitting_lustre", "running", "testing"];

/// Returns the programs that are checked here.
pub(crate) fn checked_programs() -> Vec<PathBuf> {
    let mut paths = files_below("tests/ui", PROGRAMS);
    paths.retain(|path| {
        let folder = path.parent().and_then(Path::file_name);
        !RUN_BY_TOOLS
            .iter()
            .any(|name| folder.is_some_and(|folder| folder == *name))
    });
    paths
}

#[test]
fn programs_give_the_messages_beside_them() {
    let programs = checked_programs().into_iter();
    let wrong = programs.filter_map(|path| compare_with_expected(&path, &message(&path)));
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn there_are_programs_and_each_message_has_one() {
    let programs = files_below("tests/ui", PROGRAMS);
    assert!(
        programs.len() >= 150,
        "only {} broken programs",
        programs.len()
    );
    let messages: BTreeSet<PathBuf> = programs.iter().map(|path| message_file(path)).collect();
    let stray: Vec<_> = files_below("tests/ui", &[".stderr"])
        .into_iter()
        .filter(|p| !messages.contains(p))
        .collect();
    assert!(stray.is_empty(), "messages without a program: {stray:?}");
}

/// A code without a program has a message that nobody has reviewed.
#[test]
fn every_code_has_a_program() {
    let messages = files_below("tests/ui", &[".stderr"]);
    let messages: String = messages
        .iter()
        .filter_map(|path| std::fs::read_to_string(path).ok())
        .collect();
    let shown = |code: &&Code| messages.contains(&format!("{} {code}:", code.severity().as_str()));
    let unseen: Vec<_> = Code::ALL
        .iter()
        .filter(|code| !NO_PROGRAM.contains(code) && !shown(code))
        .collect();
    assert!(unseen.is_empty(), "no program in tests/ui gives {unseen:?}");
}

/// Every prefix of every program here and of every example must compile without a panic, within the time limit.
///
/// Prefixes that end within a word or with white space differ little from one that ends behind the word, and they are
/// six of seven: only `RPI_PREFIXES=all` compiles them too. Of the others, `RPI_PREFIXES=words` compiles all and the default
/// one of four, which are other ones in each program.
#[test]
fn no_prefix_of_a_program_makes_the_compiler_panic_or_hang() {
    let programs = [checked_programs(), files_below("examples", PROGRAMS)].concat();
    let next = AtomicUsize::new(0);
    let check_programs = || {
        while let Some(path) = programs.get(next.fetch_add(1, Ordering::Relaxed)) {
            check_prefixes(path);
        }
    };
    // The scope panics where one of its threads did.
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, |n| n.get()) {
            scope.spawn(check_programs);
        }
    });
}

fn check_prefixes(path: &Path) {
    let text = std::fs::read_to_string(path).expect("it is UTF-8");
    let chosen = std::env::var("RPI_PREFIXES").unwrap_or_default();
    let (all, of_words) = (chosen == "all", chosen == "words");
    let mut before = ' ';
    let mut number = text.len();
    for (end, next) in text.char_indices() {
        let is_like_other = is_of_word(before) && is_of_word(next) || before.is_whitespace();
        before = next;
        number += usize::from(!is_like_other);
        if !all && (is_like_other || !of_words && !number.is_multiple_of(4)) {
            continue;
        }
        let start = Instant::now();
        let output = check(&name(path), &text[..end]);
        let shown = render(&output.diagnostics, &output.sources, Style::PLAIN);
        assert_eq!(shown.is_empty(), output.diagnostics.is_empty());
        assert!(
            start.elapsed() < HANG,
            "{} up to byte {end}",
            path.display()
        );
    }
}

fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn message(path: &Path) -> String {
    let text = std::fs::read_to_string(path).expect("it is UTF-8");
    let CheckOutput {
        diagnostics,
        sources,
    } = check(&name(path), &text);
    render(&diagnostics, &sources, Style::PLAIN)
}

/// Returns the name under which messages show a program, without folders of this machine.
pub(crate) fn name(path: &Path) -> String {
    let below = path
        .strip_prefix(workspace_root().join("tests/ui"))
        .unwrap_or(path);
    below.to_string_lossy().replace('\\', "/")
}

fn message_file(path: &Path) -> PathBuf {
    path.with_extension("stderr")
}
