//! Generator of the TextMate grammar for editors, from the keyword table of the compiler.
//!
//! The grammar only highlights; it does not parse. Contextual keywords are highlighted where the lexer may accept them,
//! not after `.` and not before `=`, `:`, `,` or `)`, and not where only a name can be: before an operator or the end of an
//! equation.

use rpi_syntax::ops::{BINARY, UNARY};
use rpi_syntax::{KEYWORDS, Keyword, KeywordContext};
use serde_json::{Value, json};

const NAME: &str = "[A-Za-z_][A-Za-z0-9_']*";
const TYPES: &[&str] = &["bool", "int", "real"];
const CONSTANTS: &[&str] = &["true", "false"];
/// Contextual keywords after which another keyword or the end of a statement may come: `on any then end;`.
const LAST: &[&str] = &["any", "end"];
/// What follows a name and no keyword: an operator with two operands, `;` or `]`. A minus without a space belongs to the operand
/// after it.
const AFTER_NAME: &str = r"[;\]+*^|>]|-[>\s]|<[^<]|(?:and|or|xor|mod|div|then|else|fby|nor)\b";
/// Predeclared flows, values and operators of the language, which the grammar highlights.
const PREDECLARED: &[&str] = &[
    "cancel",
    "dt",
    "first",
    "hold",
    "none",
    "predecessor",
    "present",
    "still",
    "takeover",
    "time",
];

pub(super) fn grammar() -> String {
    let grammar = json!({
        "name": "RPI",
        "scopeName": "source.rpi",
        "fileTypes": ["rpi", "lus"],
        "patterns": [
            { "include": "#comments" }, { "include": "#literals" }, { "include": "#types" },
            { "include": "#declarations" }, { "include": "#words" }, { "include": "#calls" },
            { "include": "#operators" },
        ],
        "repository": {
            "comments": { "patterns": comments() },
            "literals": { "patterns": literals() },
            "declarations": { "patterns": declarations() },
            "words": { "patterns": words() },
            "types": { "patterns": types() },
            "calls": { "patterns": calls() },
            "operators": { "patterns": [match_rule("keyword.operator", r"->|=>|\?\?|<>|<=|>=|<<|>>|\*\*|[-+*/%^|#=<>?]")] },
        },
    });
    // A value of strings and lists can always be serialised.
    serde_json::to_string_pretty(&grammar).unwrap_or_default() + "\n"
}

fn comments() -> Value {
    json!([
        match_rule("comment.line.documentation", r"--\|.*$"),
        match_rule("comment.line.double-dash", r"--.*$"),
        match_rule("comment.line.double-slash", r"//.*$"),
        begin_end_rule("comment.block", r"\(\*", r"\*\)"),
        begin_end_rule("comment.block", r"/\*", r"\*/"),
    ])
}

fn literals() -> Value {
    // The point of `1..3` belongs to the range, and that of `a.1` to no number.
    let number = r"(\b0[xX][0-9a-fA-F]+|\b[0-9]+(?:\.(?!\.)[0-9]*)?(?:[eE][-+]?[0-9]+)?|(?<![\w.])\.[0-9]+(?:[eE][-+]?[0-9]+)?)";
    json!([
        { "name": scope("string.quoted.double"), "begin": "\"", "end": "\"|$",
          "patterns": [match_rule("constant.character.escape", r"\\.")] },
        { "match": format!(r"{number}(?:(\[)([^\]]*)(\]))?"),
          "captures": { "1": { "name": scope("constant.numeric") }, "3": { "name": scope("keyword.other.unit") } } },
    ])
}

/// Returns the patterns of types: `real` with its unit, and the type after the colon of a declaration. The colon of an
/// argument (`f(x: y)`) and of a step (`again: Go()`) looks the same; there a value follows, which ends with a bracket,
/// an operator or a semicolon that a type does not have.
fn types() -> Value {
    let capitalised = r"[A-Z][A-Za-z0-9_']*";
    json!([
        { "match": r"(?<![.\w'])(real)\s*(\[)([^\]]*)(\])",
          "captures": { "1": { "name": scope("storage.type") }, "3": { "name": scope("keyword.other.unit") } } },
        { "match": format!(r"(:)\s*({capitalised})(?=\s*(?:[;)?^=]|when\b|<<|\(\s*{NAME}\s*(?:\.|\bin\b|\))|$))"),
          "captures": { "2": { "name": scope("entity.name.type") } } },
        { "match": format!(r"\b(type|datatype|device)\s+({NAME})"),
          "captures": { "1": { "name": scope("keyword.control") }, "2": { "name": scope("entity.name.type") } } },
    ])
}

/// Returns the patterns of calls, `f(x)` and `f<<n>>(x)`, and of members after a dot.
fn calls() -> Value {
    json!([
        { "match": format!(r"(\.)({NAME})"),
          "captures": { "2": { "name": scope("variable.other.member") } } },
        { "match": format!(r"\b((?:{NAME}::)*{NAME})(?=\s*(?:\(|<<))"),
          "captures": { "1": { "name": scope("entity.name.function.call") } } },
    ])
}

/// Returns the pattern that highlights a declaring keyword and the name that it declares.
fn declarations() -> Value {
    let words = alternatives(
        KEYWORDS
            .iter()
            .filter(|w| w.context == KeywordContext::Declaration)
            .map(|w| w.text),
    );
    json!([{
        "match": format!(r"\b(node|function|{words})\s+({NAME})"),
        "captures": { "1": { "name": scope("keyword.control") }, "2": { "name": scope("entity.name.function") } },
    }])
}

fn words() -> Value {
    let (reserved, by_place): (Vec<_>, Vec<_>) = KEYWORDS
        .iter()
        .partition(|w| w.context == KeywordContext::Reserved);
    let reserved = reserved.iter().map(|w| w.text);
    let special: Vec<&str> = [TYPES, CONSTANTS].concat();
    let (operators, control): (Vec<&str>, Vec<&str>) = reserved
        .filter(|text| !special.contains(text))
        .partition(|text| is_operator(text));
    // Types may end a declaration.
    let (at_ends, inside): (Vec<&Keyword>, Vec<&Keyword>) = by_place
        .into_iter()
        .partition(|w| LAST.contains(&w.text) || w.context == KeywordContext::Conversion);
    let contextual = |words: Vec<&Keyword>, not_before: &str| {
        let words = alternatives(words.iter().map(|w| w.text));
        match_rule(
            "keyword.control.contextual",
            &format!(r"(?<![.\w'])(?:{words})(?![\w'])(?!\s*(?:{not_before}))"),
        )
    };
    json!([
        words_rule("storage.type", TYPES),
        words_rule("constant.language", CONSTANTS),
        words_rule("keyword.operator.word", &operators),
        words_rule("keyword.control", &control),
        contextual(at_ends, "[=:,)]"),
        contextual(inside, &format!("[=:,)]|{AFTER_NAME}")),
        words_rule("variable.language", PREDECLARED),
    ])
}

fn is_operator(text: &str) -> bool {
    BINARY.iter().any(|row| row.spelling == text) || UNARY.iter().any(|row| row.spelling == text)
}

fn words_rule(name: &str, words: &[&str]) -> Value {
    match_rule(
        name,
        &format!(
            r"(?<![.\w'])(?:{})(?![\w'])",
            alternatives(words.iter().copied())
        ),
    )
}

fn alternatives<'a>(words: impl Iterator<Item = &'a str>) -> String {
    let mut words: Vec<&str> = words.collect();
    words.sort_unstable();
    words.join("|")
}

fn match_rule(name: &str, pattern: &str) -> Value {
    json!({ "name": scope(name), "match": pattern })
}

fn begin_end_rule(name: &str, begin: &str, end: &str) -> Value {
    json!({ "name": scope(name), "begin": begin, "end": end })
}

fn scope(name: &str) -> String {
    format!("{name}.rpi")
}
