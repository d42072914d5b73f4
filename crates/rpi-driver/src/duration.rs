//! Durations on the command line: `1ms`, `250us`, `0.5s`.

use std::fmt;

const UNITS: &[(&str, f64)] = &[("ns", 1.0), ("us", 1e3), ("ms", 1e6), ("s", 1e9)];

/// Error: a text is not a duration. It has the reason.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DurationError(String);

impl fmt::Display for DurationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for DurationError {}

/// Parses a positive duration, a number with one of the units ns, us, ms and s, as in `0.5s`. Returns it in
/// nanoseconds.
///
/// # Errors
/// If the unit is missing or unknown, or the number is invalid, not positive or longer than a year.
pub fn parse_duration(text: &str) -> Result<u64, DurationError> {
    let unit = text.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
    let (number, unit) = (&text[..text.len() - unit.len()], unit.trim());
    let factor = UNITS.iter().find(|(name, _)| *name == unit);
    let no_unit = || DurationError("expected a number with one of the units ns, us, ms, s".into());
    let (_, factor) = factor.ok_or_else(no_unit)?;
    let number: f64 = number
        .parse()
        .map_err(|_| DurationError(format!("`{number}` is not a number")))?;
    let nanos = (number * factor).round();
    if (1.0..=3.2e16).contains(&nanos) {
        Ok(nanos as u64)
    } else {
        let message = "expected a duration above 0 and below one year";
        Err(DurationError(message.to_owned()))
    }
}

/// Formats a duration in nanoseconds with the largest of the units ns, us, ms and s in which it is at least 1.
#[must_use]
pub fn format_duration(nanos: u64) -> String {
    let mut fitting = UNITS
        .iter()
        .rev()
        .filter(|(_, factor)| nanos as f64 >= *factor);
    let (unit, factor) = fitting.next().unwrap_or(&UNITS[0]);
    let value = format!("{:.3}", nanos as f64 / factor);
    format!(
        "{} {unit}",
        value.trim_end_matches('0').trim_end_matches('.')
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_read_with_their_unit() {
        let all = ["1ms", "250us", "0.5s", "12ns", "2 ms"].map(parse_duration);
        assert_eq!(
            all,
            [
                Ok(1_000_000),
                Ok(250_000),
                Ok(500_000_000),
                Ok(12),
                Ok(2_000_000)
            ]
        );
    }

    #[test]
    fn everything_else_is_refused() {
        for text in ["", "5", "ms", "-1ms", "0s", "1h", "1e9s", "nan s", "1.2.3s"] {
            assert!(parse_duration(text).is_err(), "{text}");
        }
    }

    #[test]
    fn spans_are_written_in_a_fitting_unit() {
        let all = [1_000_000, 2_500_000_000, 999, 1_234_567].map(format_duration);
        assert_eq!(all, ["1 ms", "2.5 s", "999 ns", "1.235 ms"]);
    }
}
