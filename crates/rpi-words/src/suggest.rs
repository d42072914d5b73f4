//! "Did you mean" suggestions: the valid name nearest to an invalid one.

/// Maximum length of a name in bytes for which a suggestion is searched: a longer one is no mistyped name, and would take
/// time and memory.
const MAX_NAME: usize = 1024;

/// Returns the candidate that is most similar to `name`, for a "did you mean" message; `None` if no candidate is
/// similar. The distance of a candidate is at most one edit per three characters of `name` (two edits for five
/// characters), and less than the length of `name`. Equal distances are decided alphabetically.
pub fn suggest<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> Option<String> {
    if name.len() > MAX_NAME {
        return None;
    }
    let mut wanted = NameMatcher::new(name);
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates.filter(|candidate| *candidate != name) {
        let found = wanted.distance(candidate).map(|far| (far, candidate));
        best = best.into_iter().chain(found).min();
    }
    best.map(|(_, candidate)| candidate.to_owned())
}

/// Name to which candidates are compared, with the buffers that all comparisons reuse.
struct NameMatcher {
    name: Vec<char>,
    /// Maximum number of changed, missing and additional characters of a similar name.
    limit: usize,
    other: Vec<char>,
    /// Last three rows of the table by which the distance is computed: the current row, the previous row, and the row
    /// before that.
    rows: [Vec<usize>; 3],
}

impl NameMatcher {
    fn new(name: &str) -> NameMatcher {
        let name: Vec<char> = lower(name).collect();
        let limit = ((name.len() + 1) / 3).min(name.len().saturating_sub(1));
        NameMatcher {
            name,
            limit,
            other: Vec::new(),
            rows: Default::default(),
        }
    }

    /// Returns the case-insensitive Damerau-Levenshtein distance to another name, in its "optimal string alignment"
    /// form: the minimum number of insertions, deletions, substitutions and swaps of neighbours, with no position
    /// edited twice. Returns `None` if the distance exceeds the limit.
    fn distance(&mut self, other: &str) -> Option<usize> {
        self.other.clear();
        self.other.extend(lower(other));
        if self.name.len().abs_diff(self.other.len()) > self.limit {
            return None;
        }
        self.rows[1].clear();
        self.rows[1].extend(0..=self.other.len());
        for i in 1..=self.name.len() {
            self.fill(i);
            let nearest = |row: &Vec<usize>| row.iter().min().copied();
            if self.rows[..2].iter().filter_map(nearest).min() > Some(self.limit) {
                return None;
            }
            self.rows.rotate_right(1);
        }
        self.rows[1]
            .last()
            .copied()
            .filter(|far| *far <= self.limit)
    }

    /// Computes the current row of the distance table: the distances of the first `i` characters of the name from each
    /// prefix of the other name.
    fn fill(&mut self, i: usize) {
        let (a, b) = (&self.name, &self.other);
        let [row, last, two_ago] = &mut self.rows;
        row.clear();
        row.push(i);
        for j in 1..=b.len() {
            let same = usize::from(a[i - 1] != b[j - 1]);
            let mut best = (last[j] + 1).min(row[j - 1] + 1).min(last[j - 1] + same);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(two_ago[j - 2] + 1);
            }
            row.push(best);
        }
    }
}

fn lower(text: &str) -> impl Iterator<Item = char> {
    text.chars().flat_map(char::to_lowercase)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(name: &str, candidates: &[&str]) -> Option<String> {
        suggest(name, candidates.iter().copied())
    }

    #[test]
    fn distances() {
        let within = |limit: usize, a: &str, b: &str| {
            let mut wanted = NameMatcher::new(a);
            wanted.limit = limit;
            wanted.distance(b)
        };
        assert_eq!(within(9, "", "abc"), Some(3));
        assert_eq!(within(9, "abc", ""), Some(3));
        assert_eq!(within(9, "pose", "psoe"), Some(1));
        assert_eq!(within(9, "Kitten", "sitting"), Some(3));
        assert_eq!(within(9, "ca", "abc"), Some(3));
        assert_eq!(within(3, "kitten", "sitting"), Some(3));
        assert_eq!(within(2, "kitten", "sitting"), None);
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
