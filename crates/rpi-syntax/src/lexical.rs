//! Findings about single tokens and comments.

use crate::ast::Number;
use crate::habits;
use crate::numeral::{self, Numeral};
use rpi_diag::{Code, FileId, Finding, Fix, Span};

/// Characters that come with copied text, and what was meant.
const LOOKALIKES: &[(char, &str)] = &[
    ('\u{201c}', "\""),
    ('\u{201d}', "\""),
    ('\u{2018}', "'"),
    ('\u{2019}', "'"),
    ('\u{2013}', "-"),
    ('\u{2014}', "--"),
    ('\u{2212}', "-"),
    ('\u{00d7}', "*"),
    ('\u{00b7}', "*"),
    ('\u{2264}', "<="),
    ('\u{2265}', ">="),
    ('\u{2260}', "<>"),
    ('\u{2192}', "->"),
    ('\u{00b0}', "[deg]"),
    ('\u{00a0}', " "),
];

/// How much of what follows a `'` belongs to a text in such quotes.
pub(crate) fn quoted(rest: &str) -> usize {
    let line = rest.lines().next().unwrap_or_default();
    let is_name = |text: &str| text.contains(['(', ')', ';', ':', '=']);
    let end = line.find('\'').filter(|end| !is_name(&line[..*end]));
    end.map_or(0, |end| end + 1)
}

/// `'a'` as elsewhere.
fn in_single_quotes(span: Span, text: &str) -> Finding {
    let inner = text.trim_matches('\'');
    let mut letters = inner.chars();
    let finding = Finding::new(
        Code::RPI0002,
        "texts and characters do not stand in single quotes",
    )
    .at(span, "no part of the language");
    match (letters.next(), letters.next()) {
        (Some(letter), None) => finding
            .help(format!(
                "a character is a number here: {}; what has a name is better a value of an enum",
                letter as u32
            ))
            .fix(Fix::maybe("write its number").replace(span, (letter as u32).to_string())),
        _ => {
            let meant = format!("\"{inner}\"");
            finding.fix(Fix::maybe(format!("write `{meant}`")).replace(span, meant))
        }
    }
}

pub(crate) fn unknown(span: Span, text: &str) -> Finding {
    if text.len() > 2 && text.starts_with('\'') && text.ends_with('\'') {
        return in_single_quotes(span, text);
    }
    let what = match text.chars().count() {
        1 => "unknown character",
        _ => "unknown characters",
    };
    let finding = Finding::new(Code::RPI0002, format!("{what} `{}`", text.escape_debug()))
        .at(span, "no part of the language");
    match meant(text) {
        None if text == "'" => finding
            .help("a name stands without it: `last x`, a type parameter is `<<type T>>`")
            .fix(Fix::maybe("delete it").replace(span, "")),
        Some(meant) => {
            let title = format!("write `{meant}`");
            finding.fix(Fix::maybe(title).replace(span, meant))
        }
        None => finding,
    }
}

/// The text with every lookalike replaced; [`None`] if other characters are in it.
fn meant(text: &str) -> Option<String> {
    let one = |c: char| {
        LOOKALIKES
            .iter()
            .find(|(from, _)| *from == c)
            .map(|(_, to)| *to)
    };
    text.chars().map(one).collect()
}

pub(crate) fn open_comment(span: Span, text: &str) -> Finding {
    let close = match text.starts_with("/*") {
        true => "*/",
        false => "*)",
    };
    let start = Span {
        end: span.start + 2,
        ..span
    };
    Finding::new(Code::RPI0003, "this comment has no end")
        .at(start, "begins here and runs to the end of the file")
        .help(format!(
            "close it with `{close}`, or write `--` for a comment that ends with its line"
        ))
}

pub(crate) fn open_str(span: Span) -> Finding {
    Finding::new(Code::RPI0005, "this text has no end")
        .at(span, "no `\"` before the end of the line")
        .fix(Fix::maybe("insert `\"`").insert_after(span, "\""))
}

/// What a word behind a number seems to be.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Behind {
    /// A word of the language.
    Keyword,
    /// Something that the text declares or defines.
    Name,
    /// A unit.
    Unit,
}

/// A number and, right behind it, a word.
pub(crate) fn number_runs_into_word(
    span: Span,
    text: &str,
    digits: usize,
    behind: Behind,
) -> Finding {
    let (number, word) = text.split_at(digits);
    let unit = format!("{number}[{word}]");
    let (meant, why) = match behind {
        Behind::Keyword => (format!("{number} {word}"), "a space goes between them"),
        Behind::Name => (
            format!("{number} * {word}"),
            "a product is written with `*`",
        ),
        Behind::Unit => (unit.clone(), "a unit is written in brackets"),
    };
    let finding = Finding::new(
        Code::RPI0007,
        format!("the number `{number}` runs into the word `{word}`"),
    )
    .at(span, why)
    .fix(Fix::maybe(format!("write `{meant}`")).replace(span, meant));
    match behind {
        Behind::Name => {
            finding.fix(Fix::maybe(format!("write `{unit}`, a unit")).replace(span, unit))
        }
        _ => finding,
    }
}

/// A literal as another language writes it.
pub(crate) fn foreign_literal(span: Span, text: &str, code: Code, numeral: &Numeral) -> Finding {
    let finding = Finding::new(code, numeral.message.clone()).at(span, numeral.seen);
    let Some(meant) = &numeral.meant else {
        return finding
            .help("write a number, maybe with its unit: `10`, `0x1F`, `2.5e-3`, `500[ms]`");
    };
    let title = format!("write `{meant}`");
    if numeral.is_sure {
        return finding.fix(Fix::sure(title).replace(span, meant.as_str()));
    }
    let finding = finding.fix(Fix::maybe(title).replace(span, meant.as_str()));
    match text.split_at(numeral::digits(text)) {
        (number, unit @ ("F" | "L" | "l")) => {
            let other = format!("{number}[{unit}]");
            finding.fix(Fix::maybe(format!("write `{other}`, a unit")).replace(span, other))
        }
        _ => finding,
    }
}

/// A number that no 64-bit value holds; `is_machine` if one without sign may be meant.
pub(crate) fn check_number(span: Span, text: &str, is_machine: bool) -> Option<Finding> {
    // So short a number without an exponent always fits.
    if text.len() < 16 && text.bytes().all(|b| b.is_ascii_digit() || b == b'.') {
        return None;
    }
    let number = Number { text: text.into() };
    let (holds, kind) = match number.is_int() {
        true if is_machine => (number.bits().is_some(), "a 64-bit integer"),
        true => (number.int().is_some(), "a 64-bit integer"),
        false => (number.real().is_finite(), "a 64-bit real"),
    };
    let message = || format!("`{text}` is too large for {kind}");
    (!holds).then(|| Finding::new(Code::RPI0008, message()).at(span, "out of range"))
}

/// A comment as other languages begin it, by a mark of so many bytes; sure if it can not be an operator.
pub(crate) fn foreign_comment(span: Span, mark: u32, is_sure: bool) -> Finding {
    let mark = Span {
        end: span.start + mark,
        ..span
    };
    let title = "write `--`";
    let fix = if is_sure {
        Fix::sure(title)
    } else {
        Fix::maybe(title)
    };
    Finding::new(Code::RPI0013, "comments begin with `--`")
        .at(mark, "taken as the begin of a comment")
        .fix(fix.replace(mark, "--"))
}

/// `x // 2`
pub(crate) fn double_slash(span: Span, text: &str) -> Finding {
    let word = habits::apart(span, text, "div");
    Finding::new(
        Code::RPI0016,
        "an integer quotient is written `div`, a comment begins with `--`",
    )
    .at(span, "`//` is of another language")
    .fix(Fix::maybe("write `div`").replace(span, word))
}

pub(crate) fn contract_comment(span: Span) -> Finding {
    Finding::new(Code::RPI0014, "a contract in a comment is not read")
        .at(span, "skipped")
        .help("what is read: `assume`, `guarantee`, `mode`, `import`, `var`, `const`")
}

pub(crate) fn property_comment(span: Span) -> Finding {
    Finding::new(Code::RPI0014, "a property in a comment is not read")
        .at(span, "skipped")
        .help("what is read: `--%PROPERTY`, maybe a name in quotes, a Boolean and `;`, on one line of the body of a node in a `.lus` file")
}

pub(crate) fn too_many_faults(from: Span) -> Finding {
    Finding::new(Code::RPI0011, "the file has too many faults")
        .at(from, "the rest is not read")
        .help("correct those before it first")
}

pub(crate) fn file_too_long(file: FileId) -> Finding {
    Finding::new(Code::RPI0011, "the file is too long to be read")
        .at(Span::new(file, 0, 0), "more than 2 GB")
}
