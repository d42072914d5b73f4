//! Links between documents must have targets, and the table of contents of the book must be complete.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use rpi_testkit::{files_below, workspace_root};

#[test]
fn links_between_documents_lead_somewhere() {
    for path in documents() {
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        let folder = path.parent().unwrap_or(Path::new(""));
        for target in links(&text) {
            assert!(
                folder.join(&target).exists(),
                "{}: no file {target}",
                path.display()
            );
        }
    }
}

#[test]
fn the_book_lists_every_chapter_once() {
    let source = workspace_root().join("docs/src");
    let summary = std::fs::read_to_string(source.join("SUMMARY.md")).unwrap_or_default();
    let listed: Vec<PathBuf> = links(&summary).map(|target| source.join(target)).collect();
    let unique: BTreeSet<&PathBuf> = listed.iter().collect();
    assert_eq!(unique.len(), listed.len(), "a chapter is listed twice");
    for chapter in files_below("docs/src", &[".md"]) {
        let known = unique.contains(&chapter) || chapter.ends_with("SUMMARY.md");
        assert!(known, "{} is not in SUMMARY.md", chapter.display());
    }
}

/// Returns the documents at the root, the book, and the notes beside code and data.
fn documents() -> Vec<PathBuf> {
    let found = files_below("", &[".md"]);
    found
        .into_iter()
        .filter(|path| !path.to_string_lossy().contains("/pages/"))
        .collect()
}

/// Returns the targets of `[text](target)` that are files. Web addresses, anchors within a document and code are
/// ignored.
fn links(markdown: &str) -> impl Iterator<Item = String> + '_ {
    let mut in_code = false;
    let prose = markdown.lines().filter(move |line| {
        in_code ^= line.trim_start().starts_with("```");
        !in_code
    });
    let outside_quotes = prose.flat_map(|line| line.split('`').step_by(2));
    let targets = outside_quotes.flat_map(|text| text.split("](").skip(1));
    let targets = targets.filter_map(|rest| rest.split(')').next());
    let targets = targets.map(|target| target.split('#').next().unwrap_or("").to_owned());
    targets.filter(|target| !target.is_empty() && !target.contains("://"))
}
