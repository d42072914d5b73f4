//! Colours of the samples by the query for syntax highlighting. `RPI_BLESS=1 cargo xtask tree-sitter` writes the snapshots.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use tree_sitter::{Parser, Query, QueryCursor, StreamingIterator};
use tree_sitter_rpi::{HIGHLIGHTS, LANGUAGE};

/// Returns the colour of each coloured range of bytes. Of several patterns that match a node, the last one counts, as in editors.
fn colours(text: &str) -> BTreeMap<(usize, usize), String> {
    let mut parser = Parser::new();
    parser.set_language(&LANGUAGE.into()).unwrap();
    let tree = parser.parse(text, None).unwrap();
    assert!(!tree.root_node().has_error(), "the sample does not parse");
    let query = Query::new(&LANGUAGE.into(), HIGHLIGHTS).unwrap();
    let mut cursor = QueryCursor::new();
    let mut captures = cursor.captures(&query, tree.root_node(), text.as_bytes());
    let mut found: BTreeMap<(usize, usize), (usize, String)> = BTreeMap::new();
    while let Some((matched, index)) = captures.next() {
        let capture = matched.captures[*index];
        let range = (capture.node.start_byte(), capture.node.end_byte());
        let name = query.capture_names()[capture.index as usize].to_owned();
        let known = found.entry(range).or_default();
        if matched.pattern_index >= known.0 {
            *known = (matched.pattern_index, name);
        }
    }
    found.into_iter().map(|(range, (_, name))| (range, name)).collect()
}

/// Returns the lines of a text, each followed by its coloured words and their colours.
fn snapshot(text: &str) -> String {
    let colours = colours(text);
    let mut written = String::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        // Writing to a string cannot fail.
        let _ = writeln!(written, "{}", line.trim_end());
        for ((from, to), name) in colours.range((start, 0)..(start + line.len(), 0)) {
            let word = text[*from..*to].lines().next().unwrap_or_default();
            let _ = writeln!(written, "    {word}  {name}");
        }
        start += line.len();
    }
    written
}

fn samples() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../samples");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_program = |path: &PathBuf| path.extension().is_some_and(|e| e == "rpi" || e == "lus");
    files.filter(is_program).collect()
}

#[test]
fn colours_of_the_samples_are_those_of_the_snapshots() {
    let samples = samples();
    assert!(samples.len() >= 2, "{samples:?}");
    for sample in samples {
        let got = snapshot(&std::fs::read_to_string(&sample).unwrap());
        let file = PathBuf::from(format!("{}.tree-sitter.txt", sample.display()));
        if std::env::var_os("RPI_BLESS").is_some() {
            std::fs::write(&file, &got).unwrap();
        }
        let expected = std::fs::read_to_string(&file).unwrap_or_default();
        assert_eq!(got, expected, "{}", file.display());
    }
}
