//! Diagnostics about single tokens and comments.

use crate::Dialect;
use crate::ast::Number;
use crate::foreign;
use crate::foreign_literal::{self, ForeignLiteral};
use crate::unit_suffix::is_common_unit;
use rpi_diag::{Code, Diagnostic, FileId, Fix, Span};

/// Characters from copied text that look like RPI symbols, each with the symbol to write instead.
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

/// Returns the length in bytes of the rest of a string in single quotes, closing quote included; 0 if the line has no
/// such string. `rest` is the text after the opening `'`.
pub(crate) fn single_quoted_len(rest: &str) -> usize {
    let line = rest.lines().next().unwrap_or_default();
    let is_name = |text: &str| text.contains(['(', ')', ';', ':', '=']);
    let end = line.find('\'').filter(|end| !is_name(&line[..*end]));
    end.map_or(0, |end| end + 1)
}

/// Reports a character or string in single quotes, which other languages have. `text` includes the quotes.
fn single_quotes(span: Span, text: &str) -> Diagnostic {
    let inner = text.trim_matches('\'');
    let mut letters = inner.chars();
    let report =
        |message| Diagnostic::new(Code::RPI0002, message).primary(span, "not a valid token");
    match (letters.next(), letters.next()) {
        (Some(letter), None) => report("there are no character literals")
            .help(format!(
                "use the number of the character, {}, or a value of an enum",
                letter as u32
            ))
            .fix(Fix::maybe("replace it by its number").replace(span, (letter as u32).to_string())),
        _ => {
            let meant = format!("\"{inner}\"");
            report("a string literal is written in double quotes")
                .fix(Fix::maybe(format!("write `{meant}`")).replace(span, meant))
        }
    }
}

/// Reports adjacent characters that form no token (RPI0002).
pub(crate) fn unknown_chars(span: Span, text: &str) -> Diagnostic {
    if text.len() > 2 && text.starts_with('\'') && text.ends_with('\'') {
        return single_quotes(span, text);
    }
    let what = match text.chars().count() {
        1 => "unknown character",
        _ => "unknown characters",
    };
    let diagnostic = Diagnostic::new(Code::RPI0002, format!("{what} `{}`", text.escape_debug()))
        .primary(span, "not a valid token");
    match replace_lookalikes(text) {
        None if text == "'" => diagnostic
            .help("a name is written without it: `last x`; a type parameter is `<<type T>>`")
            .fix(Fix::maybe("delete it").replace(span, "")),
        Some(meant) => {
            let title = format!("write `{meant}`");
            diagnostic.fix(Fix::maybe(title).replace(span, meant))
        }
        None => diagnostic,
    }
}

/// Returns the text with each character that looks like a symbol replaced by the symbol; [`None`] if it contains other
/// characters.
fn replace_lookalikes(text: &str) -> Option<String> {
    let one = |c: char| {
        LOOKALIKES
            .iter()
            .find(|(from, _)| *from == c)
            .map(|(_, to)| *to)
    };
    text.chars().map(one).collect()
}

pub(crate) fn unterminated_comment(span: Span, text: &str) -> Diagnostic {
    let close = match text.starts_with("/*") {
        true => "*/",
        false => "*)",
    };
    let start = Span {
        end: span.start + 2,
        ..span
    };
    Diagnostic::new(Code::RPI0003, "this comment is not closed")
        .primary(start, "opened here, extends to the end of the file")
        .help(format!(
            "close it with `{close}`, or write `--` for a comment up to the end of the line"
        ))
}

pub(crate) fn unterminated_string(span: Span) -> Diagnostic {
    Diagnostic::new(Code::RPI0005, "this string literal is not closed")
        .primary(span, "no `\"` before the end of the line")
        .fix(Fix::maybe("insert `\"`").insert_after(span, "\""))
}

/// Classification of a word that directly follows a number.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum SuffixKind {
    /// The word is a keyword.
    Keyword,
    /// The word is a name that the text declares or defines.
    Name,
    /// The word is a unit of measure.
    Unit,
}

/// Reports a number directly followed by a word (RPI0007). `text` holds both, of which the number has `digits` bytes;
/// `behind` classifies the word.
pub(crate) fn invalid_suffix(
    span: Span,
    text: &str,
    digits: usize,
    behind: SuffixKind,
) -> Diagnostic {
    let (number, word) = text.split_at(digits);
    let unit = format!("{number}[{word}]");
    let (meant, why) = match behind {
        SuffixKind::Keyword => (
            format!("{number} {word}"),
            "a space is required between them",
        ),
        SuffixKind::Name => (
            format!("{number} * {word}"),
            "a product is written with `*`",
        ),
        SuffixKind::Unit => (unit.clone(), "a unit is written in brackets"),
    };
    let diagnostic = Diagnostic::new(
        Code::RPI0007,
        format!("invalid suffix `{word}` on the number `{number}`"),
    )
    .primary(span, why)
    .fix(Fix::maybe(format!("write `{meant}`")).replace(span, meant));
    match behind {
        SuffixKind::Name if is_common_unit(word) => {
            diagnostic.fix(Fix::maybe(format!("write `{unit}`, a unit")).replace(span, unit))
        }
        _ => diagnostic,
    }
}

/// Reports a literal in the notation of another language, with a fix that writes its RPI form if there is one.
pub(crate) fn foreign_literal(
    span: Span,
    text: &str,
    code: Code,
    numeral: &ForeignLiteral,
) -> Diagnostic {
    let diagnostic = Diagnostic::new(code, numeral.message.clone()).primary(span, numeral.label);
    let Some(meant) = &numeral.replacement_text else {
        return diagnostic
            .help("write a number, optionally with a unit: `10`, `0x1F`, `2.5e-3`, `500[ms]`");
    };
    let title = format!("write `{meant}`");
    if numeral.is_sure {
        return diagnostic.fix(Fix::sure(title).replace(span, meant.as_str()));
    }
    let diagnostic = diagnostic.fix(Fix::maybe(title).replace(span, meant.as_str()));
    match text.split_at(foreign_literal::number_len(text)) {
        // An integer with `L` is a long integer of C; one with `F` or a fraction may be a quantity.
        (number, unit @ ("F" | "L" | "l")) if unit == "F" || number.contains('.') => {
            let other = format!("{number}[{unit}]");
            diagnostic.fix(Fix::maybe(format!("write `{other}`, a unit")).replace(span, other))
        }
        _ => diagnostic,
    }
}

/// Returns a diagnostic (RPI0008) if a number does not fit into 64 bits; `None` if it fits. If `is_machine`, unsigned
/// 64-bit integers also fit.
pub(crate) fn check_number(span: Span, text: &str, is_machine: bool) -> Option<Diagnostic> {
    // A number this short without an exponent always fits.
    if text.len() < 16 && text.bytes().all(|b| b.is_ascii_digit() || b == b'.') {
        return None;
    }
    let number = Number { text: text.into() };
    let (holds, kind) = match number.is_int() {
        true if is_machine => (number.u64_value().is_some(), "a 64-bit integer"),
        true => (number.int_value().is_some(), "a 64-bit integer"),
        false => (number.real_value().is_finite(), "a 64-bit real"),
    };
    let message = || format!("`{text}` is too large for {kind}");
    let limits = match number.is_int() {
        true if is_machine => "the largest unsigned integer is 18446744073709551615",
        true => "the largest integer is 9223372036854775807; write a real for a larger number",
        false => "the largest real is about 1.8e308",
    };
    (!holds).then(|| {
        Diagnostic::new(Code::RPI0008, message())
            .primary(span, "out of range")
            .help(limits)
    })
}

/// Reports a comment with a marker of another language (RPI0013). The marker is `mark` bytes long; `is_sure` is true if
/// it cannot be an operator.
pub(crate) fn foreign_comment(span: Span, mark: u32, is_sure: bool) -> Diagnostic {
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
    Diagnostic::new(Code::RPI0013, "comments begin with `--`")
        .primary(mark, "parsed as the start of a comment")
        .fix(fix.replace(mark, "--"))
}

/// Reports `x // 2`, an integer division in other languages.
pub(crate) fn double_slash(span: Span, text: &str) -> Diagnostic {
    let word = foreign::with_spaces(span, text, "div");
    Diagnostic::new(
        Code::RPI0016,
        "integer division is written `div`; a comment begins with `--`",
    )
    .primary(span, "`//` is from another language")
    .fix(Fix::maybe("write `div`").replace(span, word))
}

/// Reports a contract in a comment (RPI0014) that has no effect. In `.rpi` files no such contract has an effect; in
/// `.lus` files a contract with an unsupported clause has none.
pub(crate) fn unsupported_contract(span: Span, dialect: Dialect) -> Diagnostic {
    let (message, help) = match dialect {
        Dialect::Rpi => (
            "a contract in a comment has no effect in an `.rpi` file",
            "write its clauses without the comment, between `con` and `noc` before `let`",
        ),
        Dialect::Lustre => (
            "unsupported contract in a comment",
            "supported clauses: `assume`, `guarantee`, `mode`, `import`, `var`, `const`",
        ),
    };
    Diagnostic::new(Code::RPI0014, message)
        .primary(span, "ignored")
        .help(help)
}

/// Reports a property in a comment (RPI0014) that has no effect: it is in an `.rpi` file, or its condition does not
/// parse.
pub(crate) fn unsupported_property(span: Span, dialect: Dialect) -> Diagnostic {
    if dialect == Dialect::Lustre {
        return Diagnostic::new(Code::RPI0014, "this property has no valid condition")
            .primary(span, "ignored: expected `--%PROPERTY condition;`")
            .help("write a complete Boolean expression, such as `--%PROPERTY x > 0;`, on one line of a node body");
    }
    Diagnostic::new(Code::RPI0014, "unsupported property in a comment")
        .primary(span, "ignored")
        .help("supported: `--%PROPERTY condition;`, with an optional name, on one line of a node body in a `.lus` file")
}

pub(crate) fn too_many_errors(from: Span) -> Diagnostic {
    Diagnostic::new(Code::RPI0011, "the file has too many errors")
        .primary(from, "the rest is not parsed")
        .help("fix the errors before this place first")
}

pub(crate) fn file_too_large(file: FileId) -> Diagnostic {
    Diagnostic::new(Code::RPI0011, "the file is too large")
        .primary(Span::new(file, 0, 0), "more than 2 GB")
}
