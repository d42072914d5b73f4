//! Which token of a source became which one of a document.
//!
//! They are the same but for what the style adds, leaves out or writes in another way, and but for parts that it sorts: where
//! a part begins, the document tells its place.

/// A token of the document.
pub(super) struct Printed<'d> {
    pub(super) text: &'d str,
    /// The token of the source that it begins with, if the part tells.
    pub(super) anchor: Option<usize>,
}

/// So many tokens may be added, left out or written in another way in a row.
const MAX_APART: usize = 24;

/// For each token of the source the one it became.
pub(super) fn align(source: &[&str], printed: &[Printed<'_>]) -> Vec<Option<usize>> {
    let mut became = vec![None; source.len()];
    let (mut from, mut to) = (0, 0);
    let mut anchored = 0;
    while to < printed.len() {
        if let Some(anchor) = printed[to].anchor.filter(|_| anchored <= to) {
            // Of some parts the word that they begin with has no place.
            let is =
                |at: Option<usize>| at.and_then(|at| source.get(at)) == Some(&printed[to].text);
            let early = !is(Some(anchor)) && is(anchor.checked_sub(1));
            (from, anchored) = (anchor - usize::from(early), to + 1);
        }
        if from >= source.len() || source[from] != printed[to].text {
            let (left_out, added) = apart(&source[from.min(source.len())..], &printed[to..]);
            if left_out == added {
                // Written in another way.
                for i in 0..added {
                    became[from + i] = Some(to + i);
                }
            }
            (from, to) = (from + left_out, to + added);
            continue;
        }
        became[from] = Some(to);
        (from, to) = (from + 1, to + 1);
    }
    became
}

/// How many tokens of each are passed over until they are the same again; not both are 0.
fn apart(source: &[&str], printed: &[Printed<'_>]) -> (usize, usize) {
    let near = &printed[..printed.len().min(2 * MAX_APART)];
    let next_part = near.iter().skip(1).position(|p| p.anchor.is_some());
    let end = next_part.map_or(near.len(), |at| at + 1);
    if source.is_empty() {
        return (0, end);
    }
    let same = |i: usize, j: usize| source[i] == printed[j].text;
    for sum in 1..=2 * MAX_APART {
        for added in (0..=sum.min(end)).rev() {
            let left_out = sum - added;
            if left_out >= source.len() || added >= end || !same(left_out, added) {
                continue;
            }
            let again = (left_out + 1, added + 1);
            if again.0 >= source.len() || again.1 >= end || same(again.0, again.1) {
                return (left_out, added);
            }
        }
    }
    match next_part {
        Some(_) => (0, end),
        None => (1, 1),
    }
}
