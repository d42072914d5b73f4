//! Fuzzing dictionary: the keywords and operators of the language, taken from its own table.

use rpi_syntax::{KEYWORDS, symbols};

/// Words for the fuzzer in addition to keywords and operators: boundary values of numbers, units and array lengths.
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

/// Returns the words of the fuzzing dictionary: all keywords and operators of the language, and the boundary values.
pub(crate) fn dictionary_words() -> impl Iterator<Item = &'static str> {
    let words = KEYWORDS.iter().map(|word| word.text);
    words.chain(symbols()).chain(NUMBERS.iter().copied())
}

/// Returns the fuzzing dictionary in the format of libFuzzer: one quoted word per line.
#[must_use]
pub fn dictionary() -> String {
    let line = |word: &str| format!("\"{}\"\n", word.replace('\\', "\\\\").replace('"', "\\\""));
    dictionary_words().map(line).collect()
}
