//! Text that must not occur in any file, such as paths of a development machine or addresses of package registries.

use std::collections::BTreeSet;

use rpi_testkit::workspace_root;
use xtask::tracked_files;

/// Forbidden texts, split in two so that this file does not contain them.
const FORBIDDEN: &[(&str, &str)] = &[
    ("/wo", "rk/"),
    ("/ho", "me/"),
    ("/ro", "ot/"),
    ("/Us", "ers/"),
    ("crates", ".io/"),
    ("index.crates", ".io"),
    ("regis", "try+http"),
    ("pypi", ".org"),
    ("npmjs", ".com"),
    ("local", "host:8"),
];

/// This file is generated and contains the registry.
const LOCK_FILE: &str = "Cargo.lock";

#[test]
fn no_file_names_a_machine_or_a_registry() {
    let mut found = Vec::new();
    for path in tracked_files()
        .iter()
        .filter(|path| !path.ends_with(LOCK_FILE))
    {
        let Ok(text) = std::fs::read_to_string(workspace_root().join(path)) else {
            continue;
        };
        for (number, line) in text.lines().enumerate() {
            if FORBIDDEN
                .iter()
                .any(|(a, b)| line.contains(&format!("{a}{b}")))
            {
                found.push(format!("{}:{}: {line}", path.display(), number + 1));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Files and folders at the root, as described in `ARCHITECTURE.md`.
const ROOT: &[&str] = &[
    ".cargo",
    ".ci",
    ".gitignore",
    "ARCHITECTURE.md",
    ".gitattributes",
    ".taplo.toml",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "Cargo.lock",
    "Cargo.toml",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "SECURITY.md",
    "bench",
    "clients",
    "clippy.toml",
    "crates",
    "deny.toml",
    "docs",
    "editor-support",
    "examples",
    "fuzz",
    "grammar",
    "robots",
    "stdlib",
    "tests",
    "xtask",
];

#[test]
fn nothing_lies_about_at_the_root() {
    let top: BTreeSet<String> = tracked_files()
        .iter()
        .filter_map(|path| Some(path.iter().next()?.to_string_lossy().into_owned()))
        .collect();
    let stray: Vec<&String> = top
        .iter()
        .filter(|name| !ROOT.contains(&name.as_str()))
        .collect();
    assert!(
        stray.is_empty(),
        "files at the root that are not listed: {stray:?}"
    );
}

#[test]
fn no_work_is_left_undone() {
    let words = [
        ("to", "do!("),
        ("unimple", "mented!("),
        ("FIX", "ME"),
        ("#[ig", "nore]"),
    ];
    let mut found = Vec::new();
    for path in tracked_files()
        .iter()
        .filter(|path| path.extension().is_some_and(|e| e == "rs"))
    {
        let Ok(text) = std::fs::read_to_string(workspace_root().join(path)) else {
            continue;
        };
        let hits = words
            .iter()
            .filter(|(a, b)| text.contains(&format!("{a}{b}")));
        found.extend(hits.map(|(a, b)| format!("{}: {a}{b}", path.display())));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}
