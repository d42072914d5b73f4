//! Counts with nouns in singular or plural.

use std::fmt::Display;

/// Returns a count with its noun in singular or plural, for example `1 error` or `2 errors`.
pub fn counted(count: impl Display, what: &str) -> String {
    let count = count.to_string();
    let ending = if count == "1" { "" } else { "s" };
    format!("{count} {what}{ending}")
}

/// Returns the wording of a number of occurrences, for example `once` or `2 times`.
pub fn times(count: impl Display) -> String {
    match counted(count, "time") {
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
            [0, 1, 2].map(|n| counted(n, "tick")),
            ["0 ticks", "1 tick", "2 ticks"]
        );
        assert_eq!([1, 21].map(times), ["once", "21 times"]);
    }
}
