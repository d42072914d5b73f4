//! Abbreviated snippets for lines that are too long to be shown whole: a window around each label, with an ellipsis
//! where text is omitted.

use crate::{Diagnostic, Label, SourceMap, Style};

/// Maximum size in bytes of a source snippet that is drawn as whole lines. A longer snippet is abbreviated.
const MAX_SNIPPET_BYTES: usize = 4000;

/// Maximum length in bytes of a source line that is drawn whole. A snippet with a longer line is abbreviated.
const MAX_LINE_BYTES: usize = 400;

/// Maximum number of characters of source text that an abbreviated snippet shows before a label, within it, and after
/// it.
const CONTEXT_CHARS: usize = 30;

/// Returns whether a diagnostic must be drawn abbreviated: one of its snippets, with one line of context on each side,
/// is too long.
pub(crate) fn is_needed(diagnostic: &Diagnostic, sources: &SourceMap) -> bool {
    let too_long = |label: &Label| {
        let bytes = sources.text(label.span.file).as_bytes();
        let (start, end) = sources.clamp(label.span);
        let before = two_lines_len(bytes[..start].iter().rev());
        let own =
            rest_of_line_len(bytes[..start].iter().rev()) + rest_of_line_len(bytes[start..].iter());
        let is_long = own > MAX_LINE_BYTES
            || next_line_len(bytes[..start].iter().rev()) > MAX_LINE_BYTES
            || next_line_len(bytes[end..].iter()) > MAX_LINE_BYTES;
        is_long || end - start + before + two_lines_len(bytes[end..].iter()) > MAX_SNIPPET_BYTES
    };
    diagnostic.labels.iter().any(too_long)
}

/// Returns the number of bytes before the next line break, counted up to [`MAX_LINE_BYTES`] + 1. A reversed iterator
/// counts backwards to the start of the line.
fn rest_of_line_len<'b>(bytes: impl Iterator<Item = &'b u8>) -> usize {
    bytes
        .take(MAX_LINE_BYTES + 1)
        .take_while(|byte| **byte != b'\n')
        .count()
}

/// Returns the length in bytes of the line after the next line break, counted up to [`MAX_LINE_BYTES`] + 1. A reversed
/// iterator gives the line before.
fn next_line_len<'b>(bytes: impl Iterator<Item = &'b u8>) -> usize {
    rest_of_line_len(
        bytes
            .take(MAX_SNIPPET_BYTES)
            .skip_while(|byte| **byte != b'\n')
            .skip(1),
    )
}

/// Returns the number of bytes before the second line break, counted up to [`MAX_SNIPPET_BYTES`] + 1.
fn two_lines_len<'b>(bytes: impl Iterator<Item = &'b u8>) -> usize {
    let mut ends = 0;
    let within = |byte: &&u8| {
        ends += usize::from(**byte == b'\n');
        ends < 2
    };
    bytes.take(MAX_SNIPPET_BYTES + 1).take_while(within).count()
}

/// Draws the headline of a diagnostic, and for each label the source text around it. Every line ends with a newline.
pub(crate) fn draw(diagnostic: &Diagnostic, sources: &SourceMap, style: Style) -> String {
    let (severity, code) = (diagnostic.severity().as_str(), diagnostic.code);
    let mut out = format!("{severity} {code}: {}\n", diagnostic.message);
    for label in diagnostic
        .labels
        .iter()
        .filter(|label| !label.span.is_none())
    {
        let name = sources.name(label.span.file);
        let at = sources.line_col(label.span);
        out.push_str(&format!(
            "  [{name}:{at}]\n{}",
            window(label, sources, style)
        ));
    }
    out
}

/// Draws the source text around a label in one line, and below it the marks and the text of the label.
fn window(label: &Label, sources: &SourceMap, style: Style) -> String {
    let text = sources.text(label.span.file);
    let (start, end) = sources.clamp(label.span);
    let dots = if style.unicode { "…" } else { "..." };
    let (before, more) = visible_part(text[..start].chars().rev());
    let lead: String = before.chars().rev().collect();
    let lead = format!("{}{lead}", if more { dots } else { "" });
    let (here, cut) = visible_part(text[start..end].chars());
    let (after, more) = if cut {
        (String::new(), true)
    } else {
        visible_part(text[end..].chars())
    };
    let tail = if more { dots } else { "" };
    let indent = lead.chars().count();
    let marks = "^".repeat(here.chars().count().max(1));
    let marked = format!("    {:indent$}{marks} {}", "", label.text);
    format!("    {lead}{here}{after}{tail}\n{}\n", marked.trim_end())
}

/// Returns the first [`CONTEXT_CHARS`] characters of a line, and whether the line has more characters. Control
/// characters are replaced by U+FFFD, tabs by spaces.
fn visible_part(chars: impl Iterator<Item = char>) -> (String, bool) {
    let mut line = chars.take_while(|c| *c != '\n');
    let shown = line.by_ref().take(CONTEXT_CHARS).map(|c| match c {
        '\t' => ' ',
        c if c.is_control() => char::REPLACEMENT_CHARACTER,
        c => c,
    });
    let shown = shown.collect();
    (shown, line.next().is_some())
}
