//! Generator of the chapter on keywords and operators, from the tables of the front end.

use std::fmt::Write;

use rpi_syntax::ops::{
    Associativity, BINARY, BinaryOpInfo, PRECEDENCE_IF, PRECEDENCE_WHEN, UNARY, UnaryOpInfo,
};
use rpi_syntax::{KEYWORDS, Keyword, KeywordContext};

use super::GENERATED_NOTICE;

pub(super) fn chapter() -> String {
    let mut out = format!("{GENERATED_NOTICE}# Keywords and operators\n\n");
    out.push_str("## Reserved words\n\nThese cannot be used as names.\n\n| word | in `.lus` | meaning |\n|---|---|---|\n");
    rows(&mut out, |word| word.context == KeywordContext::Reserved);
    out.push_str("\n## Contextual keywords\n\nThese are keywords only where the grammar expects them, and names everywhere else. ");
    out.push_str("They are never keywords after `.` or before `=`, `:`, `,` or `)`.\n\n");
    out.push_str("| word | in `.lus` | meaning |\n|---|---|---|\n");
    rows(&mut out, |word| word.context != KeywordContext::Reserved);
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

/// Operators that consist of several keywords: precedence level, form, associativity and meaning of each.
const MIXFIX_OPERATORS: [(u8, &str, &str, &str); 3] = [
    (
        PRECEDENCE_IF,
        "if c then a else b",
        "right",
        "selection in each cycle",
    ),
    (
        PRECEDENCE_IF,
        "with c then a else b",
        "right",
        "selection at compile time",
    ),
    (
        PRECEDENCE_WHEN,
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
        .chain(MIXFIX_OPERATORS.map(mixed))
        .collect();
    rows.sort_by_key(|(level, _)| *level);
    rows
}

fn binary(row: &BinaryOpInfo) -> (u8, String) {
    let groups = match row.associativity {
        Associativity::Left => "left",
        Associativity::Right => "right",
        Associativity::None => "none",
    };
    let spelling = row.spelling.replace('|', "\\|");
    (
        row.precedence,
        format!(
            "| {} | `a {spelling} b` | {groups} | {}{} |\n",
            row.precedence,
            row.doc,
            only_lustre(row.only_lustre)
        ),
    )
}

fn unary(row: &UnaryOpInfo) -> (u8, String) {
    (
        row.precedence,
        format!(
            "| {} | `{} a` | | {}{} |\n",
            row.precedence,
            row.spelling,
            row.doc,
            only_lustre(row.only_lustre)
        ),
    )
}

fn only_lustre(only: bool) -> &'static str {
    if only { " (only in `.lus`)" } else { "" }
}
