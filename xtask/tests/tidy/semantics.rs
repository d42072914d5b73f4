//! Every numbered rule of the semantics must be named by a test, and tests must name only existing rules.

use std::collections::{BTreeMap, BTreeSet};

use rpi_testkit::workspace_root;
use xtask::tracked_files;

/// Rules that no test covers yet, with the reason.
const OPEN: &[(&str, &str)] = &[];

#[test]
fn every_rule_is_named_by_a_test() {
    let named = named();
    let open = |rule: &String| OPEN.iter().any(|(known, _)| known == rule);
    for rule in rules() {
        assert!(
            named.contains_key(&rule) != open(&rule),
            "{rule}: a test names it, or OPEN says why none does"
        );
    }
}

#[test]
fn tests_name_rules_that_there_are() {
    let rules = rules();
    for (rule, files) in named() {
        assert!(rules.contains(&rule), "{files:?}: there is no rule {rule}");
    }
}

/// Returns the rule numbers, such as `M5.1`: the numbered items below headings such as `## M5 Delay`.
fn rules() -> BTreeSet<String> {
    let path = workspace_root().join("docs/src/semantics.md");
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let mut rules = BTreeSet::new();
    let mut section = String::new();
    for line in text.lines() {
        if let Some(heading) = line.strip_prefix("## ") {
            section = heading.split(' ').next().unwrap_or_default().to_owned();
        }
        let number = line.split_once(". ").map_or("", |(number, _)| number);
        if !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()) {
            rules.insert(format!("{section}.{number}"));
        }
    }
    assert!(rules.len() > 40, "only {} rules", rules.len());
    rules
}

/// Returns the rules named by tests, with the files: programs in `tests/`, explanation pages (whose programs are
/// tests), and Rust tests.
fn named() -> BTreeMap<String, BTreeSet<String>> {
    let mut named: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for path in tracked_files() {
        let name = path.to_string_lossy().into_owned();
        let program = name.starts_with("tests/") && name.ends_with(".rpi");
        let page = name.starts_with("crates/rpi-diag/pages/");
        let code = name.starts_with("crates/") || name.starts_with("clients/");
        let rust = code && name.ends_with(".rs");
        if !program && !page && !rust {
            continue;
        }
        let text = std::fs::read_to_string(workspace_root().join(&path)).unwrap_or_default();
        let of_tests = match rust && !name.contains("/tests/") {
            true => text
                .split_once("#[cfg(test)]")
                .map_or("", |(_, tests)| tests),
            false => &text,
        };
        for rule in mentioned(of_tests) {
            named.entry(rule).or_default().insert(name.clone());
        }
    }
    named
}

/// Returns the words of the form `M12.3` in a text.
fn mentioned(text: &str) -> Vec<String> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '.';
    let words = text.split(|c: char| !is_part(c));
    let words = words.map(|word| word.trim_end_matches('.'));
    words
        .filter(|word| is_rule(word))
        .map(str::to_owned)
        .collect()
}

fn is_rule(word: &str) -> bool {
    let number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let parts = word.strip_prefix('M').and_then(|rest| rest.split_once('.'));
    parts.is_some_and(|(section, rule)| number(section) && number(rule))
}

#[test]
fn rules_are_told_from_other_words() {
    assert_eq!(mentioned("(M5.1, M12.3.) M5 R5.1 M5.x"), ["M5.1", "M12.3"]);
}
