//! `ARCHITECTURE.md` must name existing tests for each of its rules.

use rpi_testkit::workspace_root;
use xtask::functions;

/// Number of rules.
const RULES: usize = 10;

#[test]
fn every_rule_names_tests_that_exist() {
    let rules = rules();
    assert_eq!(
        rules.len(),
        RULES,
        "rules are numbered items under `## Rules`"
    );
    for (number, rule) in rules.iter().enumerate() {
        let tests = named_tests(rule);
        assert!(!tests.is_empty(), "rule {} names no test", number + 1);
        for (path, name) in tests {
            let text = std::fs::read_to_string(workspace_root().join(&path));
            let text = text.unwrap_or_else(|_| panic!("rule {}: no file {path}", number + 1));
            let exists = functions(&text).iter().any(|f| f.name == name);
            assert!(exists, "rule {}: {path} has no test `{name}`", number + 1);
        }
    }
}

/// Returns the numbered items of the section `## Rules`.
fn rules() -> Vec<String> {
    let text =
        std::fs::read_to_string(workspace_root().join("ARCHITECTURE.md")).unwrap_or_default();
    let section = text.split("\n## Rules").nth(1).unwrap_or("");
    let section = section.split("\n## ").next().unwrap_or("");
    let mut rules: Vec<String> = Vec::new();
    for line in section.lines() {
        if line.starts_with(|c: char| c.is_ascii_digit()) {
            rules.push(String::new());
        }
        if let Some(rule) = rules.last_mut() {
            rule.push_str(line);
            rule.push('\n');
        }
    }
    rules
}

/// Returns the tests named as `` `path/to/file.rs::test_name` ``.
fn named_tests(rule: &str) -> Vec<(String, String)> {
    let quoted = rule.split('`').skip(1).step_by(2);
    let named = quoted.filter_map(|word| word.split_once("::"));
    let named = named.filter(|(path, _)| path.ends_with(".rs"));
    named
        .map(|(path, name)| (path.to_owned(), name.to_owned()))
        .collect()
}
