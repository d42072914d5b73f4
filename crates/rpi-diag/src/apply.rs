//! Applying fixes to texts.

use crate::{Applicability, Edit, Finding};

/// The edits of all sure fixes, last place first; of edits that overlap only the first in the text is kept.
pub fn sure_edits(findings: &[Finding]) -> Vec<Edit> {
    let fixes = findings.iter().filter_map(|f| f.fixes.first());
    let sure = fixes.filter(|fix| fix.applicability == Applicability::Sure);
    let mut edits: Vec<Edit> = sure.flat_map(|fix| fix.edits.iter().cloned()).collect();
    edits.sort_by_key(|edit| (edit.span.file, edit.span.start, edit.span.end));
    edits.dedup_by(|next, kept| {
        next.span.file == kept.span.file && next.span.start < kept.span.end.max(kept.span.start + 1)
    });
    edits.reverse();
    edits
}

/// A text after edits, which are given last place first.
pub fn apply<'a>(text: &str, edits: impl Iterator<Item = &'a Edit>) -> String {
    let mut text = text.to_owned();
    for edit in edits {
        text.replace_range(edit.span.start as usize..edit.span.end as usize, &edit.text);
    }
    text
}
