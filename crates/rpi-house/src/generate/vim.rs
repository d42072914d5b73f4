//! The syntax file for Vim and Neovim, from the compiler's table of words.
//!
//! It colours; it does not parse. Words that are keywords only in places are coloured where the lexer's rule for them
//! allows it: not after `.` and not before `=`, `:`, `,` or `)`.

use std::fmt::Write as _;

use rpi_syntax::{KEYWORDS, Mode, Place};

/// Words of the table that name types and values, each with Vim's group for it.
const SPECIAL: &[(&str, &str)] = &[
    ("bool", "Type"),
    ("int", "Type"),
    ("real", "Type"),
    ("true", "Boolean"),
    ("false", "Boolean"),
];

/// What is no word: name, Vim's pattern, Vim's group. Later rows win.
const PATTERNS: &[(&str, &str, &str)] = &[
    (
        "Operator",
        r"->\|??\|<>\|<=\|>=\|[-+*/%^|#=<>?]",
        "Operator",
    ),
    (
        "Number",
        r"\<\d\+\(\.\d*\)\?\([eE][-+]\?\d\+\)\?\>\?",
        "Number",
    ),
    ("Number", r"\<0[xX]\x\+\>", "Number"),
    ("Unit", r"\(\d\|\<real\)\@<=\[[^\]]*\]", "Special"),
    ("Comment", r"--.*$", "Comment"),
    ("Doc", r"--|.*$", "SpecialComment"),
];

/// The file for a mode of the language.
pub(super) fn syntax(mode: Mode) -> String {
    let mut out = String::from(
        "\" Made by `cargo xtask gen`; changes belong into the tables it is made from.\n\
         if exists(\"b:current_syntax\")\n  finish\nendif\n\n",
    );
    let words = KEYWORDS.iter().filter(|word| word.is_in(mode));
    for word in words {
        let special = SPECIAL.iter().find(|(text, _)| *text == word.text);
        let group = special.map_or("Keyword", |(_, group)| group);
        // Writing to a string cannot fail.
        let _ = match word.place {
            Place::Reserved => writeln!(out, "syntax keyword rpi{group} {}", word.text),
            _ => writeln!(out, "syntax match rpi{group} /{}/", by_place(word.text)),
        };
    }
    for (name, pattern, _) in PATTERNS {
        let _ = writeln!(
            out,
            "syntax match rpi{name} /{}/",
            pattern.replace('/', r"\/")
        );
    }
    out.push_str("syntax region rpiComment start=/(\\*/ end=/\\*)/\n");
    out.push_str("syntax region rpiString start=/\"/ skip=/\\\\./ end=/\"\\|$/\n\n");
    let of_patterns = PATTERNS.iter().map(|(name, _, group)| (*name, *group));
    let others = [
        ("Keyword", "Keyword"),
        ("Type", "Type"),
        ("Boolean", "Boolean"),
        ("String", "String"),
    ];
    let mut links: Vec<(&str, &str)> = of_patterns.chain(others).collect();
    links.sort_unstable();
    links.dedup();
    for (name, group) in links {
        let _ = writeln!(out, "highlight default link rpi{name} {group}");
    }
    out.push_str("\nlet b:current_syntax = \"rpi\"\n");
    out
}

/// A word where it can be a keyword.
fn by_place(word: &str) -> String {
    format!(r"\.\@1<!\<{word}\>\(\s*[=:,)]\)\@!")
}
