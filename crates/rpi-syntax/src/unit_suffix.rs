//! Length of a unit written without brackets.
//!
//! Only the shape of units is known here (`mm/s^2`), and the names of a few common ones.

/// Returns the number of bytes at the start of `text` that continue a unit before it: `^2/s` for the text after the `m`
/// of `m^2/s + x`.
///
/// A factor follows without a space and has at most [`MAX_UNIT_LETTERS`] letters.
pub(crate) fn unit_rest_len(text: &str) -> usize {
    let mut end = exponent_len(text);
    loop {
        let factor = factor_len(&text[end..]);
        if factor == 0 {
            return end;
        }
        end += factor;
    }
}

/// Units that are also plausible names of flows, so that `5m` may be a length or a product.
///
/// The list is separate from the table of all units, which is in the checker. The checker runs only on programs without
/// such errors.
const COMMON_UNITS: &[&str] = &[
    "m", "mm", "cm", "s", "ms", "us", "min", "h", "g", "kg", "N", "A", "V", "W", "J", "K", "Hz",
    "rad", "deg", "rev",
];

/// Returns whether a word is a unit that is in common use and also a plausible name of a flow.
pub(crate) fn is_common_unit(word: &str) -> bool {
    COMMON_UNITS.contains(&word)
}

/// Maximum number of letters of a unit after `/` or `*`. A longer word is taken for the name of a flow.
const MAX_UNIT_LETTERS: usize = 4;

/// Returns the length in bytes of a factor of a unit, such as `/s^2` or `*m`, at the start of a text; 0 if there is
/// none.
fn factor_len(text: &str) -> usize {
    let Some(name) = text.strip_prefix(['/', '*']) else {
        return 0;
    };
    let letters = name.len()
        - name
            .trim_start_matches(|c: char| c.is_ascii_alphabetic())
            .len();
    let next = name[letters..].chars().next();
    let goes_on =
        next.is_some_and(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '(' | '.' | '['));
    match letters {
        1..=MAX_UNIT_LETTERS if !goes_on => 1 + letters + exponent_len(&name[letters..]),
        _ => 0,
    }
}

/// Returns the length in bytes of an exponent, such as `^2` or `^-1`, at the start of a text; 0 if there is none.
fn exponent_len(text: &str) -> usize {
    let Some(exponent) = text.strip_prefix('^') else {
        return 0;
    };
    let sign = usize::from(exponent.starts_with('-'));
    let digits = exponent[sign..].len()
        - exponent[sign..]
            .trim_start_matches(|c: char| c.is_ascii_digit())
            .len();
    match digits {
        0 => 0,
        digits => 1 + sign + digits,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_ends_where_an_expression_goes_on() {
        for (text, unit) in [
            ("/s;", "/s"),
            ("^2/s + x", "^2/s"),
            ("/s^-1*kg)", "/s^-1*kg"),
            (" / x", ""),
            ("/length", ""),
            ("/f(x)", ""),
            ("/a.b", ""),
            ("^", ""),
        ] {
            assert_eq!(&text[..unit_rest_len(text)], unit, "{text}");
        }
    }
}
