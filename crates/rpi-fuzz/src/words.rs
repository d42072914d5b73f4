//! The dictionary: the words and signs of the language, from its own table.

use rpi_syntax::{KEYWORDS, signs};

/// Numbers at the edges, which no table lists.
const NUMBERS: &[&str] = &[
    "0",
    "1",
    "-1",
    "2147483647",
    "4294967296",
    "9223372036854775807",
    "9223372036854775808",
    "1000000000",
    "0.0",
    "1.0e308",
    "1.0e-308",
    "1e999",
    "[m]",
    "[deg]",
    "<<1>>",
    "^1000000",
];

/// Every word and sign of the language, and numbers at the edges.
pub(crate) fn words() -> impl Iterator<Item = &'static str> {
    let words = KEYWORDS.iter().map(|word| word.text);
    words.chain(signs()).chain(NUMBERS.iter().copied())
}

/// The words in the form that fuzzers read: one in quotes on each line.
#[must_use]
pub fn dictionary() -> String {
    let line = |word: &str| format!("\"{}\"\n", word.replace('\\', "\\\\").replace('"', "\\\""));
    words().map(line).collect()
}
