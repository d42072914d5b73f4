//! Typical first mistakes of users of other languages: each must give one diagnostic, at the right location, with the
//! correct form.
//!
//! Each program in `tests/first-mistakes` has one mistake. Its first two lines state the location of the primary label,
//! and words that the diagnostic must contain, separated by ` | `.

use std::path::{Path, PathBuf};

use rpi_diag::Diagnostic;
use rpi_testkit::{files_below, workspace_root};

use crate::compile::check;

/// Smallest expected number of programs.
const LEAST: usize = 400;

#[test]
fn first_mistakes_get_one_message_that_says_what_to_write() {
    let programs = files_below("tests/first-mistakes", &[".rpi", ".lus"]);
    assert!(programs.len() >= LEAST, "only {}", programs.len());
    let wrong: Vec<String> = programs.iter().filter_map(|path| wrong(path)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Returns what is wrong with the diagnostic of a program, if anything.
fn wrong(path: &Path) -> Option<String> {
    let text = std::fs::read_to_string(path).expect("it is UTF-8");
    let name = short(path);
    let (place, words) = expected(&text).unwrap_or_else(|| panic!("{name} begins with two lines"));
    let output = check(&name, &text);
    let [diagnostic] = &output.diagnostics[..] else {
        let messages: Vec<&str> = output
            .diagnostics
            .iter()
            .map(|f| f.message.as_str())
            .collect();
        return Some(format!(
            "{name}: one diagnostic expected, found {messages:?}"
        ));
    };
    let found = output.sources.line_col(diagnostic.span());
    let found = format!("{}:{}", found.line, found.col);
    if found != place {
        return Some(format!("{name}: expected at {place}, found at {found}"));
    }
    let all = in_words(diagnostic);
    let lacks: Vec<&str> = words
        .into_iter()
        .filter(|word| !all.contains(word))
        .collect();
    if !lacks.is_empty() {
        return Some(format!("{name}: {lacks:?} not in\n{all}"));
    }
    let has_way_out = !diagnostic.help.is_empty() || !diagnostic.fixes.is_empty();
    (!has_way_out).then(|| format!("{name}: no help and no fix"))
}

/// Returns the location and the words stated in the first lines of a program.
fn expected(text: &str) -> Option<(&str, Vec<&str>)> {
    let mut lines = text.lines();
    let place = lines.next()?.strip_prefix("-- at: ")?;
    let words = lines.next()?.strip_prefix("-- says: ")?;
    let words = words.split(" | ").filter(|word| !word.is_empty());
    Some((place, words.collect()))
}

/// Returns all texts of a diagnostic.
fn in_words(diagnostic: &Diagnostic) -> String {
    let mut all = vec![diagnostic.message.clone()];
    all.extend(diagnostic.labels.iter().map(|label| label.text.clone()));
    all.extend(diagnostic.help.iter().cloned());
    for fix in &diagnostic.fixes {
        all.push(fix.title.clone());
        all.extend(fix.edits.iter().map(|edit| edit.text.clone()));
    }
    all.join("\n")
}

/// Returns the path relative to the workspace, without folders of this machine.
fn short(path: &Path) -> String {
    let root: PathBuf = workspace_root();
    let below = path.strip_prefix(root).unwrap_or(path);
    below.to_string_lossy().replace('\\', "/")
}
