//! Literals of IEC 61131-3 with `#`: `16#FF`, `T#500ms`, `INT#5`, `BOOL#TRUE`, `Mode#Idle`.

use super::{ForeignLiteral, LiteralReplacement, duration};

/// Label of the diagnostics about literals of IEC 61131-3.
const LABEL: &str = "literal of IEC 61131-3";

/// Prefixes of duration literals, in lower case.
const DURATIONS: &[&str] = &["t", "time", "lt", "ltime"];

/// Prefixes of literals for dates and times of day, in lower case.
const DATES: &[&str] = &[
    "d",
    "date",
    "ld",
    "ldate",
    "tod",
    "time_of_day",
    "ltod",
    "dt",
    "date_and_time",
    "ldt",
];

/// Prefixes of integer and bit string literals, in lower case.
const INTEGERS: &[&str] = &[
    "sint", "int", "dint", "lint", "usint", "uint", "udint", "ulint", "byte", "word", "dword",
    "lword",
];

/// Prefixes of literals for real numbers, in lower case.
const REALS: &[&str] = &["real", "lreal"];

/// Converts a literal of IEC 61131-3, which has the form `prefix#value`, to RPI.
pub(crate) fn convert_iec(text: &str) -> ForeignLiteral {
    let (head, body) = text.split_once('#').unwrap_or(("", text));
    let lower = head.to_ascii_lowercase();
    let is = |names: &[&str]| names.contains(&lower.as_str());
    match head.parse() {
        Ok(base) => convert_based(base, text, body),
        Err(_) if is(DURATIONS) => convert_duration(body),
        Err(_) if is(DATES) => {
            ForeignLiteral::unknown("dates and times of day are not supported".to_owned(), LABEL)
        }
        Err(_) if is(INTEGERS) => convert_integer(text, body),
        Err(_) if is(REALS) => convert_real(body),
        Err(_) if lower == "bool" => convert_bool(body),
        Err(_) => convert_enum_value(text, body),
    }
}

/// Returns the integer that digits denote in a base from 2 to 36; `None` for an invalid digit or an overflow.
fn value(base: u32, digits: &str) -> Option<u64> {
    let digits = digits.replace('_', "");
    let is_base = (2..=36).contains(&base);
    is_base.then(|| u64::from_str_radix(&digits, base).ok())?
}

/// Converts a literal with a base, such as `16#FF`, to RPI. `digits` is the text after the `#`, `text` the whole
/// literal.
fn convert_based(base: u32, text: &str, digits: &str) -> ForeignLiteral {
    let Some(value) = value(base, digits) else {
        return ForeignLiteral::unknown(format!("`{text}` is not a valid number"), LABEL);
    };
    let meant = match base {
        16 => format!("0x{}", digits.replace('_', "")),
        _ => value.to_string(),
    };
    ForeignLiteral::number(format!("this number is written `{meant}`"), LABEL, meant)
}

/// Converts a duration literal such as `T#500ms`, whose text after the `#` is `body`.
fn convert_duration(body: &str) -> ForeignLiteral {
    let (sign, length) = match body.strip_prefix(['+', '-']) {
        Some(length) if body.starts_with('-') => ("-", length),
        Some(length) => ("", length),
        None => ("", body),
    };
    let Some((number, unit)) = duration::parse(length) else {
        return ForeignLiteral::unknown(
            "a duration is a number with a unit: `500[ms]`".to_owned(),
            LABEL,
        );
    };
    let meant = format!("{sign}{number}[{unit}]");
    ForeignLiteral {
        replacement: LiteralReplacement::Number(number, Some(unit)),
        ..ForeignLiteral::number(format!("a duration is written `{meant}`"), LABEL, meant)
    }
}

/// Converts a typed integer such as `INT#5` or `WORD#16#FF`, whose text after the first `#` is `body`.
fn convert_integer(text: &str, body: &str) -> ForeignLiteral {
    let (sign, digits) = match body.strip_prefix('-') {
        Some(digits) => ("-", digits),
        None => ("", body.trim_start_matches('+')),
    };
    let plain = match digits.split_once('#') {
        Some((base, digits)) => base.parse().ok().and_then(|base| value(base, digits)),
        None => value(10, digits),
    };
    match plain {
        // A value that every integer type can hold is the same without the type. A larger one may be a bit pattern.
        Some(value) => ForeignLiteral {
            replacement: LiteralReplacement::Number(value.to_string(), None),
            is_sure: sign.is_empty() && value <= super::MAX_COMMON_INT,
            ..ForeignLiteral::number(
                "a number is written without a type prefix".to_owned(),
                LABEL,
                format!("{sign}{value}"),
            )
        },
        None => ForeignLiteral::unknown(format!("`{text}` is not a valid number"), LABEL),
    }
}

/// Converts a typed real number such as `REAL#1.5`, whose text after the `#` is `body`.
fn convert_real(body: &str) -> ForeignLiteral {
    let plain = body.replace('_', "");
    let digits = plain.trim_start_matches(['+', '-']);
    let is_number = super::number_len(digits) == digits.len() && !digits.is_empty();
    let dot = if digits.contains(['.', 'e', 'E']) {
        ""
    } else {
        ".0"
    };
    let message = "a number is written without a type prefix".to_owned();
    match is_number {
        true => ForeignLiteral {
            replacement: LiteralReplacement::Number(format!("{digits}{dot}"), None),
            ..ForeignLiteral::number(
                message,
                LABEL,
                format!("{}{dot}", plain.trim_start_matches('+')),
            )
        },
        false => ForeignLiteral::unknown(message, LABEL),
    }
}

/// Converts a typed Boolean such as `BOOL#TRUE`, whose text after the `#` is `body`.
fn convert_bool(body: &str) -> ForeignLiteral {
    let value = matches!(body.to_ascii_lowercase().as_str(), "true" | "1");
    let meant = value.to_string();
    let is_known = value || matches!(body.to_ascii_lowercase().as_str(), "false" | "0");
    ForeignLiteral {
        replacement_text: is_known.then(|| meant.clone()),
        is_sure: is_known,
        replacement: LiteralReplacement::Bool(value),
        ..ForeignLiteral::unknown(
            "a Boolean is written without a type prefix".to_owned(),
            LABEL,
        )
    }
}

/// Converts a literal with an unknown prefix, such as `Mode#Idle`. It is most likely a value of an enum. `body` is the
/// text after the `#`.
fn convert_enum_value(text: &str, body: &str) -> ForeignLiteral {
    let is_name = body.starts_with(|c: char| c.is_ascii_alphabetic()) && !body.contains(['#', '.']);
    match is_name {
        true => ForeignLiteral {
            replacement_text: Some(body.to_owned()),
            replacement: LiteralReplacement::Name(body.to_owned()),
            ..ForeignLiteral::unknown(
                "a value of an enum is written without its type".to_owned(),
                LABEL,
            )
        },
        false => ForeignLiteral::unknown(format!("`{text}` is not a valid literal"), LABEL),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_with_their_type_are_worth_what_they_are_there() {
        for (text, meant) in [
            ("16#FF", Some("0xFF")),
            ("16#ff_00", Some("0xff00")),
            ("2#1010", Some("10")),
            ("8#17", Some("15")),
            ("2#12", None),
            ("1#0", None),
            ("T#500ms", Some("500[ms]")),
            ("TIME#1s", Some("1[s]")),
            ("t#1.5s", Some("1.5[s]")),
            ("T#1m30s", Some("90[s]")),
            ("T#1h_2m", Some("62[min]")),
            ("T#5m", Some("5[min]")),
            ("LTIME#3us", Some("3[us]")),
            ("T#-5s", Some("-5[s]")),
            ("T#1s2h", None),
            ("T#5", None),
            ("T#1.5m3s", None),
            ("INT#5", Some("5")),
            ("INT#-5", Some("-5")),
            ("WORD#16#FF", Some("255")),
            ("REAL#1", Some("1.0")),
            ("LREAL#-1.5", Some("-1.5")),
            ("BOOL#TRUE", Some("true")),
            ("BOOL#0", Some("false")),
            ("Mode#Idle", Some("Idle")),
            ("DATE#2020", None),
        ] {
            assert_eq!(
                convert_iec(text).replacement_text.as_deref(),
                meant,
                "{text}"
            );
        }
    }
}
