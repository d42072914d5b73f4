//! Generator of the chapter on keywords and operators, from the tables of the front end.

use std::fmt::Write;

use rpi_syntax::ops::{BINARY, BinaryRow, Grouping, LEVEL_IF, LEVEL_WHEN, UNARY, UnaryRow};
use rpi_syntax::{KEYWORDS, Keyword, Place};

use super::MARK;

pub(super) fn chapter() -> String {
    let mut out = format!("{MARK}# Keywords and operators\n\n");
    out.push_str("## Reserved words\n\nThese cannot be used as names.\n\n| word | in `.lus` | meaning |\n|---|---|---|\n");
    rows(&mut out, |word| word.place == Place::Reserved);
    out.push_str("\n## Contextual keywords\n\nThese are keywords only where the grammar expects them, and names everywhere else. ");
    out.push_str("They are never keywords after `.` or before `=`, `:`, `,` or `)`.\n\n");
    out.push_str("| word | in `.lus` | meaning |\n|---|---|---|\n");
    rows(&mut out, |word| word.place != Place::Reserved);
    out.push_str("\n## Operators\n\nIn order of increasing precedence: a higher level binds more tightly.\n\n");
    out.push_str("| level | operator | associativity | meaning |\n|---|---|---|---|\n");
    for (_, row) in operators() {
        out.push_str(&row);
    }
    out
}

fn rows(out: &mut String, wanted: impl Fn(&Keyword) -> bool) {
    let mut words: Vec<&Keyword> = KEYWORDS.iter().filter(|word| wanted(word)).collect();
    words.sort_by_key(|word| word.text);
    for word in words {
        let lustre = match (word.in_lustre, word.in_rpi) {
            (true, false) => "only",
            (true, true) => "yes",
            (false, _) => "no",
        };
        // Writing to a string does not fail.
        let _ = writeln!(out, "| `{}` | {lustre} | {} |", word.text, word.doc);
    }
}

/// Operators that consist of several keywords: level, form, associativity, meaning.
const MIXED: [(u8, &str, &str, &str); 3] = [
    (
        LEVEL_IF,
        "if c then a else b",
        "right",
        "selection in each cycle",
    ),
    (
        LEVEL_IF,
        "with c then a else b",
        "right",
        "selection at compile time",
    ),
    (
        LEVEL_WHEN,
        "a when c",
        "left",
        "sampling: present only if `c` is true",
    ),
];

fn mixed((level, form, groups, doc): (u8, &str, &str, &str)) -> (u8, String) {
    (
        level,
        format!("| {level} | `{form}` | {groups} | {doc} |\n"),
    )
}

fn operators() -> Vec<(u8, String)> {
    let mut rows: Vec<(u8, String)> = BINARY
        .iter()
        .map(binary)
        .chain(UNARY.iter().map(unary))
        .chain(MIXED.map(mixed))
        .collect();
    rows.sort_by_key(|(level, _)| *level);
    rows
}

fn binary(row: &BinaryRow) -> (u8, String) {
    let groups = match row.grouping {
        Grouping::Left => "left",
        Grouping::Right => "right",
        Grouping::None => "none",
    };
    let spelling = row.spelling.replace('|', "\\|");
    (
        row.level,
        format!(
            "| {} | `a {spelling} b` | {groups} | {}{} |\n",
            row.level,
            row.doc,
            only_lustre(row.only_lustre)
        ),
    )
}

fn unary(row: &UnaryRow) -> (u8, String) {
    (
        row.level,
        format!(
            "| {} | `{} a` | | {}{} |\n",
            row.level,
            row.spelling,
            row.doc,
            only_lustre(row.only_lustre)
        ),
    )
}

fn only_lustre(only: bool) -> &'static str {
    if only { " (only in `.lus`)" } else { "" }
}
