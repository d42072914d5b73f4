//! Suggestions for misspelt words.

/// Returns the word of `known` nearest to the misspelt `word`, by edit distance; `None` if none is near enough.
pub(super) fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let ranked = known
        .iter()
        .map(|candidate| (edit_distance(word, candidate), *candidate));
    let (distance, candidate) = ranked.min()?;
    (distance <= (word.chars().count() / 3).max(1)).then_some(candidate)
}

/// Returns the edit distance of two words: the number of insertions, deletions, substitutions and transpositions of
/// neighbours (optimal string alignment).
fn edit_distance(one: &str, other: &str) -> usize {
    let (one, other): (Vec<char>, Vec<char>) = (one.chars().collect(), other.chars().collect());
    let mut rows: Vec<Vec<usize>> = vec![(0..=other.len()).collect()];
    for i in 1..=one.len() {
        let mut row = vec![i];
        for j in 1..=other.len() {
            let changed = rows[i - 1][j - 1] + usize::from(one[i - 1] != other[j - 1]);
            let best = changed.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            let swapped =
                i > 1 && j > 1 && one[i - 1] == other[j - 2] && one[i - 2] == other[j - 1];
            row.push(if swapped {
                best.min(rows[i - 2][j - 2] + 1)
            } else {
                best
            });
        }
        rows.push(row);
    }
    rows[one.len()][other.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_found_and_strangers_are_not() {
        let known = ["joints", "limits", "latency", "lag"];
        assert_eq!(nearest("joint", &known), Some("joints"));
        assert_eq!(nearest("limtis", &known), Some("limits"));
        assert_eq!(nearest("latnecy", &known), Some("latency"));
        assert_eq!(nearest("colour", &known), None);
        assert_eq!(nearest("x", &[]), None);
    }
}
