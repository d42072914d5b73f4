//! Duration literals of IEC 61131-3, such as `T#1m30s`.

/// Units of a duration in descending order: IEC name, RPI name, length in nanoseconds.
const UNITS: &[(&str, &str, u64)] = &[
    ("d", "d", 86_400_000_000_000),
    ("h", "h", 3_600_000_000_000),
    ("m", "min", 60_000_000_000),
    ("s", "s", 1_000_000_000),
    ("ms", "ms", 1_000_000),
    ("us", "us", 1_000),
    ("ns", "ns", 1),
];

/// Number in a duration literal, with the index of its unit in [`UNITS`].
type Part<'t> = (&'t str, usize);

/// Converts a duration without its prefix, such as `1m30s`, to a number and an RPI unit, the smallest one in the text.
/// Returns [`None`] if the text is malformed.
pub(super) fn parse(text: &str) -> Option<(String, &'static str)> {
    let text = text.to_ascii_lowercase().replace('_', "");
    let mut parts = Vec::new();
    let mut rest = text.as_str();
    while !rest.is_empty() {
        let (part, next) = part(rest)?;
        // IEC 61131-3 requires units in descending order.
        if parts.last().is_some_and(|(_, unit)| *unit >= part.1) {
            return None;
        }
        parts.push(part);
        rest = next;
    }
    let ((last, unit), longer) = parts.split_last()?;
    let (_, name, length) = UNITS[*unit];
    let (whole, fraction) = last.split_once('.').unwrap_or((last, ""));
    let mut sum: u64 = whole.parse().ok()?;
    for (number, unit) in longer {
        let number: u64 = number.parse().ok()?;
        sum = sum.checked_add(number.checked_mul(UNITS[*unit].2 / length)?)?;
    }
    let number = match fraction {
        "" => sum.to_string(),
        _ => format!("{sum}.{fraction}"),
    };
    Some((number, name))
}

/// Returns the first number of a duration with its unit, and the rest of the text; `None` if the text begins otherwise.
fn part(text: &str) -> Option<(Part<'_>, &str)> {
    let end = text.find(|c: char| !c.is_ascii_digit() && c != '.')?;
    let (number, rest) = text.split_at(end);
    let letters = rest.find(|c: char| !c.is_ascii_alphabetic());
    let (unit, rest) = rest.split_at(letters.unwrap_or(rest.len()));
    let row = UNITS.iter().position(|(there, ..)| *there == unit)?;
    let is_number =
        number.starts_with(|c: char| c.is_ascii_digit()) && number.matches('.').count() <= 1;
    (is_number && !number.ends_with('.')).then_some(((number, row), rest))
}
