//! Property tests of the formatter with comments and line breaks inserted between random tokens.
//!
//! Formatting is idempotent, and all comments are kept in their order.

use crate::support::{assert_same, programs};
use proptest::prelude::*;
use rpi_syntax::{Dialect, format, source_tokens};
use std::path::Path;

/// Texts that are inserted between two tokens. `#` is replaced by a unique word.
const INSERTED: &[&str] = &[
    "(*#*)",
    " (*#*) ",
    "\n(*#*)",
    "(*#*)\n",
    "--#\n",
    "\n--#\n",
    " --#\n\n",
    "\n--| #\n",
    "(*#\n*)",
    "\n\n",
];

/// Returns the test programs: those of `tests/programs` and those of `tests/unformatted`.
fn all() -> Vec<(String, Dialect)> {
    let programs = programs().into_iter().map(|p| (p.text, p.mode));
    let mut all: Vec<(String, Dialect)> = programs.collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/unformatted");
    let files = std::fs::read_dir(folder).expect("the folder is part of the crate");
    let mut paths: Vec<_> = files.map(|file| file.expect("readable").path()).collect();
    paths.sort();
    for path in paths {
        let text = std::fs::read_to_string(&path).expect("programs are UTF-8");
        all.push((text, Dialect::from_path(&path.display().to_string())));
    }
    all
}

/// Returns a text with `PUT[what]` inserted before the given tokens.
fn insert_texts(text: &str, mode: Dialect, put: &[(prop::sample::Index, usize)]) -> String {
    let borders: Vec<usize> = source_tokens(text, mode)
        .iter()
        .map(|p| p.range.start)
        .collect();
    let mut places: Vec<(usize, usize)> = put
        .iter()
        .map(|(index, what)| (borders[index.index(borders.len())], *what))
        .collect();
    places.sort_unstable();
    let mut with = text.to_owned();
    for (i, (at, what)) in places.into_iter().enumerate().rev() {
        with.insert_str(at, &INSERTED[what].replace('#', &format!("k{i}")));
    }
    with
}

/// Returns the unique words of the inserted comments, in text order.
fn marks(text: &str) -> Vec<&str> {
    let is_mark = |word: &&str| {
        word.strip_prefix('k')
            .is_some_and(|n| n.parse::<u8>().is_ok())
    };
    let words = text.split(|c: char| !c.is_alphanumeric());
    words.filter(is_mark).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn what_stands_between_tokens_is_formatted_at_once(
        program in any::<prop::sample::Index>(),
        put in prop::collection::vec((any::<prop::sample::Index>(), 0..INSERTED.len()), 1..6),
    ) {
        let all = all();
        let (text, mode) = &all[program.index(all.len())];
        let text = insert_texts(text, *mode, &put);
        // Some insertions give a text with errors, which is not formatted.
        if let Ok(once) = format(&text, *mode) {
            let again = format(&once, *mode).unwrap_or_else(|_| panic!("has errors:\n{once}"));
            assert_same(&once, &again, "formatting again changes something");
            // The style moves `restart every` after `every` in an `activate`, so comments may change their order.
            if !text.contains("activate") {
                prop_assert_eq!(marks(&text), marks(&once), "in\n{}\n---\n{}", text, once);
            }
        }
    }
}
