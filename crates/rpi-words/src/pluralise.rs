//! Counts with singular and plural nouns.

use std::fmt::Display;

/// Returns a count with its noun in the singular or plural: `1 error`, `2 errors`. `what` is the noun in the singular,
/// whose plural must end in `s`.
pub fn with_noun(count: impl Display, what: &str) -> String {
    let count = count.to_string();
    let ending = if count == "1" { "" } else { "s" };
    format!("{count} {what}{ending}")
}

/// Returns a number of repetitions in words: `once` for 1, `2 times` for 2.
pub fn times(count: impl Display) -> String {
    match with_noun(count, "time") {
        once if once == "1 time" => "once".to_owned(),
        more => more,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_one() {
        assert_eq!(
            [0, 1, 2].map(|n| with_noun(n, "tick")),
            ["0 ticks", "1 tick", "2 ticks"]
        );
        assert_eq!([1, 21].map(times), ["once", "21 times"]);
    }
}
