//! "Did you mean": the nearest of the names that would have been right.

/// The candidate nearest to `name`, if one is near enough to be a slip of the fingers: at most one
/// change for every three characters (two for five), and fewer changes than characters. Equally near ones are
/// decided by the alphabet, so that the answer does not depend on the order of the candidates.
pub fn suggest<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> Option<String> {
    let wanted: Vec<char> = name.to_lowercase().chars().collect();
    let limit = ((wanted.len() + 1) / 3).min(wanted.len().saturating_sub(1));
    candidates
        .filter(|candidate| *candidate != name)
        .map(|candidate| (distance(&wanted, &lower(candidate)), candidate))
        .filter(|(far, _)| *far <= limit)
        .min()
        .map(|(_, candidate)| candidate.to_owned())
}

fn lower(text: &str) -> Vec<char> {
    text.to_lowercase().chars().collect()
}

/// Damerau-Levenshtein distance in its "optimal string alignment" form: the least number of
/// insertions, deletions, substitutions and swaps of neighbours that make `a` into `b`, no place
/// changed twice.
fn distance(a: &[char], b: &[char]) -> usize {
    let mut two_ago = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let same = usize::from(a[i - 1] != b[j - 1]);
            let mut best = (last[j] + 1).min(row[j - 1] + 1).min(last[j - 1] + same);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                let before: &Vec<usize> = &two_ago;
                best = best.min(before[j - 2] + 1);
            }
            row.push(best);
        }
        two_ago = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(name: &str, candidates: &[&str]) -> Option<String> {
        suggest(name, candidates.iter().copied())
    }

    #[test]
    fn distances() {
        let far = |a: &str, b: &str| distance(&lower(a), &lower(b));
        assert_eq!(far("", "abc"), 3);
        assert_eq!(far("abc", ""), 3);
        assert_eq!(far("pose", "psoe"), 1);
        assert_eq!(far("kitten", "sitting"), 3);
        assert_eq!(far("ca", "abc"), 3);
    }

    #[test]
    fn slips_are_found() {
        assert_eq!(near("pse", &["speed", "pose"]).as_deref(), Some("pose"));
        assert_eq!(
            near("Travelled", &["travelled"]).as_deref(),
            Some("travelled")
        );
        assert_eq!(
            near("traveled", &["done", "travelled"]).as_deref(),
            Some("travelled")
        );
    }

    #[test]
    fn other_words_are_not() {
        assert_eq!(near("x", &["y", "z"]), None);
        assert_eq!(near("speed", &["torque"]), None);
        assert_eq!(near("", &["a"]), None);
    }

    #[test]
    fn the_answer_does_not_depend_on_the_order() {
        assert_eq!(near("at_x", &["at_c", "at_b"]).as_deref(), Some("at_b"));
        assert_eq!(near("at_x", &["at_b", "at_c"]).as_deref(), Some("at_b"));
    }
}
