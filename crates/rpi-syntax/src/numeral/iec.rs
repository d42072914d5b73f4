//! Literals of IEC 61131-3 with `#`: `16#FF`, `T#500ms`, `INT#5`, `BOOL#TRUE`, `Mode#Idle`.

use super::{Numeral, Read, duration};

/// Label of the diagnostics.
const SEEN: &str = "literal of IEC 61131-3";

/// Prefixes of durations, in lower case.
const DURATIONS: &[&str] = &["t", "time", "lt", "ltime"];

/// Prefixes of dates and times of day, in lower case.
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

/// Prefixes of integers and bit strings, in lower case.
const INTEGERS: &[&str] = &[
    "sint", "int", "dint", "lint", "usint", "uint", "udint", "ulint", "byte", "word", "dword",
    "lword",
];

/// Prefixes of real numbers, in lower case.
const REALS: &[&str] = &["real", "lreal"];

/// Converts a literal with `#` by its prefix.
pub(crate) fn typed(text: &str) -> Numeral {
    let (head, body) = text.split_once('#').unwrap_or(("", text));
    let lower = head.to_ascii_lowercase();
    let is = |names: &[&str]| names.contains(&lower.as_str());
    match head.parse() {
        Ok(base) => based(base, text, body),
        Err(_) if is(DURATIONS) => timed(body),
        Err(_) if is(DATES) => {
            Numeral::unknown("dates and times of day are not supported".to_owned(), SEEN)
        }
        Err(_) if is(INTEGERS) => integer(text, body),
        Err(_) if is(REALS) => real(body),
        Err(_) if lower == "bool" => truth(body),
        Err(_) => named(text, body),
    }
}

/// Returns the value of digits in a base from 2 to 36.
fn value(base: u32, digits: &str) -> Option<u64> {
    let digits = digits.replace('_', "");
    let is_base = (2..=36).contains(&base);
    is_base.then(|| u64::from_str_radix(&digits, base).ok())?
}

/// Converts a based integer: `16#FF`.
fn based(base: u32, text: &str, digits: &str) -> Numeral {
    let Some(value) = value(base, digits) else {
        return Numeral::unknown(format!("`{text}` is not a valid number"), SEEN);
    };
    let meant = match base {
        16 => format!("0x{}", digits.replace('_', "")),
        _ => value.to_string(),
    };
    Numeral::number(format!("this number is written `{meant}`"), SEEN, meant)
}

/// Converts a duration: `T#500ms`.
fn timed(body: &str) -> Numeral {
    let (sign, length) = match body.strip_prefix(['+', '-']) {
        Some(length) if body.starts_with('-') => ("-", length),
        Some(length) => ("", length),
        None => ("", body),
    };
    let Some((number, unit)) = duration::read(length) else {
        return Numeral::unknown(
            "a duration is a number with a unit: `500[ms]`".to_owned(),
            SEEN,
        );
    };
    let meant = format!("{sign}{number}[{unit}]");
    Numeral {
        read: Read::Number(number, Some(unit)),
        ..Numeral::number(format!("a duration is written `{meant}`"), SEEN, meant)
    }
}

/// Converts a typed integer: `INT#5`, `WORD#16#FF`.
fn integer(text: &str, body: &str) -> Numeral {
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
        Some(value) => Numeral {
            read: Read::Number(value.to_string(), None),
            is_sure: sign.is_empty() && value <= super::SMALL,
            ..Numeral::number(
                "a number is written without a type prefix".to_owned(),
                SEEN,
                format!("{sign}{value}"),
            )
        },
        None => Numeral::unknown(format!("`{text}` is not a valid number"), SEEN),
    }
}

/// Converts a typed real number: `REAL#1.5`.
fn real(body: &str) -> Numeral {
    let plain = body.replace('_', "");
    let digits = plain.trim_start_matches(['+', '-']);
    let is_number = super::digits(digits) == digits.len() && !digits.is_empty();
    let dot = if digits.contains(['.', 'e', 'E']) {
        ""
    } else {
        ".0"
    };
    let message = "a number is written without a type prefix".to_owned();
    match is_number {
        true => Numeral {
            read: Read::Number(format!("{digits}{dot}"), None),
            ..Numeral::number(
                message,
                SEEN,
                format!("{}{dot}", plain.trim_start_matches('+')),
            )
        },
        false => Numeral::unknown(message, SEEN),
    }
}

/// Converts a typed Boolean: `BOOL#TRUE`.
fn truth(body: &str) -> Numeral {
    let value = matches!(body.to_ascii_lowercase().as_str(), "true" | "1");
    let meant = value.to_string();
    let is_known = value || matches!(body.to_ascii_lowercase().as_str(), "false" | "0");
    Numeral {
        meant: is_known.then(|| meant.clone()),
        is_sure: is_known,
        read: Read::Bool(value),
        ..Numeral::unknown(
            "a Boolean is written without a type prefix".to_owned(),
            SEEN,
        )
    }
}

/// Converts a literal with an unknown prefix, most likely a value of an enum: `Mode#Idle`.
fn named(text: &str, body: &str) -> Numeral {
    let is_name = body.starts_with(|c: char| c.is_ascii_alphabetic()) && !body.contains(['#', '.']);
    match is_name {
        true => Numeral {
            meant: Some(body.to_owned()),
            read: Read::Name(body.to_owned()),
            ..Numeral::unknown(
                "a value of an enum is written without its type".to_owned(),
                SEEN,
            )
        },
        false => Numeral::unknown(format!("`{text}` is not a valid literal"), SEEN),
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
            assert_eq!(typed(text).meant.as_deref(), meant, "{text}");
        }
    }
}
