//! Alignment of the tokens of a source with the tokens of the formatted document.
//!
//! The two sequences differ by tokens that the style adds, omits or rewrites, and by parts that it sorts. The document
//! holds the source offset of each part, down to single names and numbers (its anchors). So only the few tokens between
//! two anchors are compared, by their longest common subsequence.

use std::ops::Range;

/// Word of the printed document, which is aligned with the words of the source. A word is a token other than `,` and
/// `;`.
pub(super) struct DocWord<'d> {
    pub(super) text: &'d str,
    /// Index of the source word at the same source offset, if the offset of the printed word is known.
    pub(super) anchor: Option<usize>,
}

/// Returns for each source word the index of its printed word, or `None` if the formatter omitted the word.
pub(super) fn align(source: &[&str], printed: &[DocWord<'_>]) -> Vec<Option<usize>> {
    let mut became = vec![None; source.len()];
    for (from, to) in anchored_ranges(source, printed) {
        let texts: Vec<&str> = printed[to.clone()].iter().map(|p| p.text).collect();
        for (i, j) in pairs(&source[from.clone()], &texts) {
            became[from.start + i] = Some(to.start + j);
        }
    }
    became
}

/// Returns pairs of ranges, of source words and of printed words, between consecutive printed words whose source offset
/// is known.
fn anchored_ranges(source: &[&str], printed: &[DocWord<'_>]) -> Vec<(Range<usize>, Range<usize>)> {
    let anchored = printed.iter().enumerate();
    let anchored = anchored.filter_map(|(to, word)| Some((anchor_token(source, word)?, to)));
    let begins: Vec<(usize, usize)> = std::iter::once((0, 0)).chain(anchored).collect();
    let mut places: Vec<usize> = begins.iter().map(|(from, _)| *from).collect();
    places.push(source.len());
    places.sort_unstable();
    let ends = begins.iter().skip(1).map(|(from, to)| (Some(*from), *to));
    let ends = ends.chain([(None, printed.len())]);
    let stretch = |((from, to), (next, end)): (&(usize, usize), (Option<usize>, usize))| {
        let after = places.partition_point(|place| place <= from);
        let behind = match next == Some(*from) {
            true => *from,
            false => places.get(after).copied().unwrap_or(*from),
        };
        (*from..behind, *to..end)
    };
    begins.iter().zip(ends).map(stretch).collect()
}

/// Returns the index of the source word that corresponds to a printed word with a known source offset; `None` if the
/// offset is unknown.
fn anchor_token(source: &[&str], word: &DocWord<'_>) -> Option<usize> {
    let at = word.anchor?.min(source.len());
    let is = |at: usize| source.get(at) == Some(&word.text);
    // Some parts begin with a keyword that is not in their span.
    let early = at.checked_sub(1).filter(|early| !is(at) && is(*early));
    Some(early.unwrap_or(at))
}

/// Returns pairs of indices into `source` and `printed`: equal words in the same order, and words between them that the
/// formatter replaced one by one.
fn pairs(source: &[&str], printed: &[&str]) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    let mut done = (0, 0);
    for (i, j) in longest_common_subsequence(source, printed)
        .into_iter()
        .chain([(source.len(), printed.len())])
    {
        if is_rewritten(&source[done.0..i], &printed[done.1..j]) {
            pairs.extend((done.0..i).zip(done.1..j));
        }
        pairs.push((i, j));
        done = (i + 1, j + 1);
    }
    pairs.pop();
    pairs
}

/// Returns whether the printed words replace the source words one by one. Parentheses only replace parentheses.
fn is_rewritten(source: &[&str], printed: &[&str]) -> bool {
    let is_round = |token: &str| matches!(token, "(" | ")");
    source.len() == printed.len()
        && (source.iter().zip(printed)).all(|(a, b)| is_round(a) == is_round(b))
}

/// Maximum number of word comparisons per range. Time and memory are quadratic in the number of words; longer ranges
/// are aligned only at their start.
const MAX_COMPARISONS: usize = 1 << 16;

/// Returns the longest common subsequence of two word lists, as pairs of indices. Lists that are too long give only
/// their common start.
fn longest_common_subsequence(source: &[&str], printed: &[&str]) -> Vec<(usize, usize)> {
    let head = source.iter().zip(printed).take_while(|(a, b)| a == b);
    let head = head.count();
    let mut same: Vec<(usize, usize)> = (0..head).map(|i| (i, i)).collect();
    let (source, printed) = (&source[head..], &printed[head..]);
    if source.len() * printed.len() > MAX_COMPARISONS {
        return same;
    }
    let lengths = lcs_lengths(source, printed);
    let (mut i, mut j) = (0, 0);
    while i < source.len() && j < printed.len() {
        if source[i] == printed[j] {
            same.push((head + i, head + j));
            (i, j) = (i + 1, j + 1);
        } else if lengths[i + 1][j] >= lengths[i][j + 1] {
            i += 1;
        } else {
            j += 1;
        }
    }
    same
}

/// Returns the lengths of the longest common subsequences of all suffixes: entry `[i][j]` is for `source[i..]` and
/// `printed[j..]`.
fn lcs_lengths(source: &[&str], printed: &[&str]) -> Vec<Vec<u32>> {
    let mut lengths = vec![vec![0; printed.len() + 1]; source.len() + 1];
    for i in (0..source.len()).rev() {
        for j in (0..printed.len()).rev() {
            lengths[i][j] = match source[i] == printed[j] {
                true => lengths[i + 1][j + 1] + 1,
                false => lengths[i + 1][j].max(lengths[i][j + 1]),
            };
        }
    }
    lengths
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Aligns two lists of words. `@2` before a word of the document is its anchor.
    fn aligned(source: &str, printed: &str) -> Vec<Option<usize>> {
        let source: Vec<&str> = source.split(' ').collect();
        let mut anchor = None;
        let mut words = Vec::new();
        for text in printed.split(' ') {
            match text.strip_prefix('@') {
                Some(place) => anchor = place.parse().ok(),
                None => words.push(DocWord {
                    text,
                    anchor: anchor.take(),
                }),
            }
        }
        align(&source, &words)
    }

    #[test]
    fn what_is_added_lies_between_what_tells_its_place() {
        let became = aligned(
            "merge ( c x 0 )",
            "merge @2 c ( true -> @3 x ) ( false -> @4 0 )",
        );
        let expected = [Some(0), None, Some(1), Some(5), Some(10), Some(11)];
        assert_eq!(became, expected);
    }

    #[test]
    fn what_is_written_in_another_way_is_paired() {
        assert_eq!(aligned("a && b", "a and b"), [Some(0), Some(1), Some(2)]);
        assert_eq!(
            aligned("W ( ) let", "W let"),
            [Some(0), None, None, Some(1)]
        );
    }

    #[test]
    fn parts_that_are_sorted_are_found() {
        let became = aligned("a 1 b 2 c 3", "@2 b 2 @0 a 1 @4 c 3");
        assert_eq!(became, [2, 3, 0, 1, 4, 5].map(Some));
    }
}
