//! Literals of other languages: their values and the equivalent RPI literals.
//!
//! This module works on the text of a literal only. The lexer finds the literals and reports the diagnostics.

mod duration;
mod iec;

pub(crate) use iec::convert_iec;

/// Literal of another language, with the texts of its diagnostic and its replacement.
#[derive(PartialEq, Debug)]
pub(crate) struct ForeignLiteral {
    /// Message of the diagnostic about the literal.
    pub(crate) message: String,
    /// Text of the label at the literal.
    pub(crate) label: &'static str,
    /// Equivalent RPI text for the fix, if there is one.
    pub(crate) replacement_text: Option<String>,
    /// Whether the replacement certainly has the same value, so that the fix can be applied automatically.
    pub(crate) is_sure: bool,
    /// Value that replaces the literal in the syntax tree.
    pub(crate) replacement: LiteralReplacement,
}

/// Value that replaces a foreign literal in the syntax tree.
#[derive(PartialEq, Debug)]
pub(crate) enum LiteralReplacement {
    /// Number with an optional unit: source text and name of the unit.
    Number(String, Option<&'static str>),
    /// The literal `true` or `false` of RPI.
    Bool(bool),
    /// Name, such as a value of an enum.
    Name(String),
}

impl ForeignLiteral {
    /// Creates a literal that is equivalent to the RPI number `text`. `seen` is the label of the diagnostic.
    fn number(message: String, seen: &'static str, text: String) -> ForeignLiteral {
        ForeignLiteral {
            message,
            label: seen,
            replacement_text: Some(text.clone()),
            is_sure: true,
            replacement: LiteralReplacement::Number(text, None),
        }
    }

    /// Creates a literal without an RPI equivalent; the syntax tree has the number 0 in its place. `seen` is the label
    /// of the diagnostic.
    fn unknown(message: String, seen: &'static str) -> ForeignLiteral {
        ForeignLiteral {
            message,
            label: seen,
            replacement_text: None,
            is_sure: false,
            replacement: LiteralReplacement::Number("0".to_owned(), None),
        }
    }
}

/// Returns the length in bytes of the decimal number at the start of a text: digits, fraction and exponent.
pub(crate) fn number_len(text: &str) -> usize {
    let bytes = text.as_bytes();
    let count = |from: usize| {
        let rest = bytes.get(from..).unwrap_or_default();
        rest.iter().take_while(|byte| byte.is_ascii_digit()).count()
    };
    let mut end = count(0);
    if bytes.get(end) == Some(&b'.') {
        end += 1 + count(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = count(end + 1 + sign);
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}

/// Converts a number in the notation of another language: `0b101`, `0o17`, `1_000`, `0xFF_FF`, `10u`, `1.0f`, `0x1Ful`.
/// `None` for other notations.
pub(crate) fn convert_number(text: &str) -> Option<ForeignLiteral> {
    convert_radix(text)
        .or_else(|| convert_grouped(text))
        .or_else(|| convert_suffixed(text))
}

/// Prefixes of binary and octal numbers, each with its base and the name of the notation in messages.
const PREFIXES: &[(&str, u32, &str)] = &[
    ("0b", 2, "binary"),
    ("0B", 2, "binary"),
    ("0o", 8, "octal"),
    ("0O", 8, "octal"),
];

/// Converts a binary or octal number: `0b1010`, `0o17`. `None` for other notations.
fn convert_radix(text: &str) -> Option<ForeignLiteral> {
    let rows = PREFIXES.iter();
    let mut found =
        rows.filter_map(|(prefix, base, name)| Some((text.strip_prefix(prefix)?, *base, *name)));
    let (digits, base, name) = found.next()?;
    let value = u64::from_str_radix(&digits.replace('_', ""), base).ok()?;
    let message = format!("{name} numbers are not supported: this is {value}");
    Some(ForeignLiteral::number(
        message,
        "expected a decimal or hexadecimal number",
        value.to_string(),
    ))
}

/// Converts a number with digit separators: `1_000`, `1_000.5`, `1'000`, `0xFF_FF`. `None` for other notations.
fn convert_grouped(text: &str) -> Option<ForeignLiteral> {
    let sign = if text.contains('\'') { '\'' } else { '_' };
    let plain = text.replace(sign, "");
    let is_number = is_hex(&plain) || number_len(&plain) == plain.len();
    let message = format!("the digits of a number are written without `{sign}`");
    (is_number && text.contains(sign))
        .then(|| ForeignLiteral::number(message, "digit separators are not allowed", plain))
}

/// Returns whether a text is a hexadecimal number with its prefix `0x`.
fn is_hex(text: &str) -> bool {
    let digits = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
    digits.is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_hexdigit()))
}

/// Type suffixes of numbers in C, Java and Rust, in lower case.
const SUFFIXES: &[&str] = &[
    "u", "l", "ul", "lu", "ll", "ull", "llu", "z", "uz", "f", "i8", "i16", "i32", "i64", "u8",
    "u16", "u32", "u64", "usize", "isize", "f32", "f64",
];

/// Suffixes that are also units in RPI, litre and farad, so that a suffixed number has two readings.
const UNIT_SUFFIXES: &[&str] = &["l", "L", "F"];

/// Converts a number with a type suffix: `10u`, `10L`, `1.0f`, `1e3f`, `0x1Fu`, `5i32`. `None` for other notations.
fn convert_suffixed(text: &str) -> Option<ForeignLiteral> {
    let end = match text.starts_with("0x") || text.starts_with("0X") {
        true => {
            2 + text[2..].len()
                - text[2..]
                    .trim_start_matches(|c: char| c.is_ascii_hexdigit())
                    .len()
        }
        false => number_len(text),
    };
    let (number, suffix) = text.split_at(end);
    let lower = suffix.to_ascii_lowercase();
    if end == 0 || !SUFFIXES.contains(&lower.as_str()) {
        return None;
    }
    let is_float = matches!(lower.as_str(), "f" | "f32" | "f64");
    let meant = match is_float && number.bytes().all(|byte| byte.is_ascii_digit()) {
        true => format!("{number}.0"),
        false => number.to_owned(),
    };
    let message = format!("a number has no type suffix: `{suffix}` is from another language");
    let numeral =
        ForeignLiteral::number(message, "every integer and every real has 64 bits", meant);
    let is_same = match lower.as_str() {
        "f64" => true,
        _ if is_float => is_exact_in_f32(number),
        "i8" | "i16" | "i32" | "u8" | "u16" | "u32" => is_small(number),
        _ => true,
    };
    let is_sure = !UNIT_SUFFIXES.contains(&suffix) && is_same;
    Some(ForeignLiteral { is_sure, ..numeral })
}

/// Largest number that every integer type, including signed 8-bit integers, can hold.
const MAX_COMMON_INT: u64 = 127;

/// Returns whether an integer, decimal or hexadecimal, is at most [`MAX_COMMON_INT`].
fn is_small(number: &str) -> bool {
    let digits = number.trim_start_matches("0x").trim_start_matches("0X");
    let base = if digits.len() < number.len() { 16 } else { 10 };
    u64::from_str_radix(digits, base).is_ok_and(|value| value <= MAX_COMMON_INT)
}

/// Returns whether a number has the same value in single and in double precision, as 0.5 has but 0.1 has not.
#[allow(clippy::float_cmp)]
fn is_exact_in_f32(number: &str) -> bool {
    let value: f64 = number.parse().unwrap_or(f64::NAN);
    f64::from(value as f32) == value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_of_other_languages_are_worth_what_they_are_there() {
        for (text, meant, is_sure) in [
            ("0b1010", "10", true),
            ("0o17", "15", true),
            ("0b1111_0000", "240", true),
            ("1_000", "1000", true),
            ("1_000.5", "1000.5", true),
            ("1'000", "1000", true),
            ("0xFF_FF", "0xFFFF", true),
            ("10u", "10", true),
            ("10UL", "10", true),
            ("10L", "10", false),
            ("1.0f", "1.0", true),
            ("0.1f", "0.1", false),
            ("1e3f", "1e3", true),
            ("2.5e-1f", "2.5e-1", true),
            ("1f", "1.0", true),
            ("0x1Fu", "0x1F", true),
            ("5i32", "5", true),
        ] {
            let numeral = convert_number(text).expect(text);
            assert_eq!(
                (numeral.replacement_text.as_deref(), numeral.is_sure),
                (Some(meant), is_sure),
                "{text}"
            );
        }
        for text in ["250mm", "5ms", "0b12", "0x1F", "2x", "1e3", "10"] {
            assert_eq!(convert_number(text), None, "{text}");
        }
    }
}
