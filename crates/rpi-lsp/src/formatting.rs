//! Formatting, as the smallest edit of whole lines, so that the cursor keeps its place in unchanged lines.

use lsp_types::{DocumentFormattingParams, Range, TextEdit};
use rpi_syntax::{Dialect, format};

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
