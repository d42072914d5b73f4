//! Formatting, as the smallest edit of whole lines, so that the cursor keeps its place in unchanged lines.

use lsp_types::{DocumentFormattingParams, DocumentRangeFormattingParams, Range, TextEdit};
use rpi_diag::FileId;
use rpi_syntax::{Dialect, format, parse};

use crate::line_index::LineIndex;
use crate::uri;
use crate::workspace::Workspace;

/// Handles `textDocument/formatting`: returns the edit that formats the document, empty if it is already formatted.
/// Returns [`None`] if a syntax error prevents formatting, or if the document is not open.
pub(crate) fn formatting(
    world: &mut Workspace,
    params: DocumentFormattingParams,
) -> Option<Vec<TextEdit>> {
    let uri = params.text_document.uri;
    let document = world.document(&uri)?;
    let mode = Dialect::from_path(&uri::to_path(&uri).display().to_string());
    let new = format(&document.text, mode).ok()?;
    let (old, lines) = (document.text.as_str(), LineIndex::new(&document.text));
    let Some((start, end, text)) = changed_lines(old, &new) else {
        return Some(Vec::new());
    };
    let at = |offset| lines.position(old, offset, world.client.encoding);
    Some(vec![TextEdit::new(
        Range::new(at(start), at(end)),
        text.to_owned(),
    )])
}

/// Handles `textDocument/rangeFormatting`: returns the edit that formats the declarations in a range of lines. Returns
/// [`None`] if a syntax error prevents formatting, or if the document is not open.
pub(crate) fn range_formatting(
    world: &mut Workspace,
    params: DocumentRangeFormattingParams,
) -> Option<Vec<TextEdit>> {
    let uri = params.text_document.uri;
    let document = world.document(&uri)?;
    let mode = Dialect::from_path(&uri::to_path(&uri).display().to_string());
    let (old, lines) = (document.text.as_str(), LineIndex::new(&document.text));
    let encoding = world.client.encoding;
    let start = lines.offset(old, params.range.start, encoding);
    let end = lines.offset(old, params.range.end, encoding);
    let new = format(old, mode).ok()?;
    let (old_parts, new_parts) = (part_ends(old, mode), part_ends(&new, mode));
    // Formatting keeps the declarations, so that their parts correspond.
    let first = old_parts.iter().filter(|part| **part <= start).count();
    let last = old_parts.iter().filter(|part| **part < end).count();
    let last = last.max(first);
    let bound = |parts: &[usize], k: usize| k.checked_sub(1).map_or(0, |k| parts[k]);
    let upto = |parts: &[usize], text: &str| parts.get(last).copied().unwrap_or(text.len());
    if old_parts.len() != new_parts.len() {
        return None;
    }
    let range = bound(&old_parts, first)..upto(&old_parts, old);
    let text = &new[bound(&new_parts, first)..upto(&new_parts, &new)];
    let Some((from, to, text)) = changed_lines(&old[range.clone()], text) else {
        return Some(Vec::new());
    };
    let at = |offset| lines.position(old, range.start + offset, encoding);
    Some(vec![TextEdit::new(
        Range::new(at(from), at(to)),
        text.to_owned(),
    )])
}

/// Returns the byte offsets at which the declarations of a text end, in text order.
fn part_ends(text: &str, mode: Dialect) -> Vec<usize> {
    let parsed = parse(FileId(0), text, mode);
    let items = parsed.file.items.iter();
    items.map(|item| item.span.end as usize).collect()
}

/// Compares two texts by lines. Returns the start and end of the differing lines in `old`, in bytes, and the lines of
/// `new` that replace them; [`None`] if the texts are equal.
fn changed_lines<'n>(old: &str, new: &'n str) -> Option<(usize, usize, &'n str)> {
    if old == new {
        return None;
    }
    let same = |pair: &(&str, &str)| pair.0 == pair.1;
    let lines = |text| str::split_inclusive(text, '\n');
    let head = lines(old).zip(lines(new)).take_while(same);
    let head: usize = head.map(|(line, _)| line.len()).sum();
    let (old_rest, new_rest) = (&old[head..], &new[head..]);
    let tail = lines(old_rest)
        .rev()
        .zip(lines(new_rest).rev())
        .take_while(same);
    let tail: usize = tail.map(|(line, _)| line.len()).sum();
    let (end, new_end) = (old.len() - tail, new_rest.len() - tail);
    Some((head, end, &new_rest[..new_end]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn only_lines_that_differ_are_touched() {
        assert_eq!(
            changed_lines("a\nb\nc\n", "a\nx\ny\nc\n"),
            Some((2, 4, "x\ny\n"))
        );
        assert_eq!(changed_lines("a", "a\n"), Some((0, 1, "a\n")));
        assert_eq!(changed_lines("a\n", "a\n"), None);
    }

    proptest! {
        #[test]
        fn the_edit_makes_the_new_text(old in "[ab\n]{0,12}", new in "[ab\n]{0,12}") {
            let mut text = old.clone();
            if let Some((start, end, with)) = changed_lines(&old, &new) {
                text.replace_range(start..end, with);
            }
            prop_assert_eq!(text, new);
        }
    }
}
