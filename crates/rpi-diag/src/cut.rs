//! Abbreviated snippets for lines that are too long to be shown whole: a window around each label, with an ellipsis
//! where text is omitted.

use crate::{Finding, Label, SourceMap, Style};

/// Largest size in bytes of a snippet that is drawn as whole lines.
const WHOLE: usize = 4000;

/// Largest length in bytes of a line that is drawn whole.
const LINE: usize = 400;

/// Largest number of characters shown before, within and after a label.
const AROUND: usize = 30;

/// Returns whether a snippet of the diagnostic, including one line of context on each side, is too long.
pub(crate) fn is_needed(finding: &Finding, sources: &SourceMap) -> bool {
    let too_long = |label: &Label| {
        let bytes = sources.text(label.span.file).as_bytes();
        let (start, end) = sources.clamp(label.span);
        let before = two_lines(bytes[..start].iter().rev());
        let own = line(bytes[..start].iter().rev()) + line(bytes[start..].iter());
        let is_long = own > LINE
            || neighbour(bytes[..start].iter().rev()) > LINE
            || neighbour(bytes[end..].iter()) > LINE;
        is_long || end - start + before + two_lines(bytes[end..].iter()) > WHOLE
    };
    finding.labels.iter().any(too_long)
}

/// Length in bytes of the rest of the line, counted up to `LINE + 1`.
fn line<'b>(bytes: impl Iterator<Item = &'b u8>) -> usize {
    bytes
        .take(LINE + 1)
        .take_while(|byte| **byte != b'\n')
        .count()
}

/// Length in bytes of the next line, counted up to `LINE + 1`.
fn neighbour<'b>(bytes: impl Iterator<Item = &'b u8>) -> usize {
    line(bytes.take(WHOLE).skip_while(|byte| **byte != b'\n').skip(1))
}

/// Length in bytes of the next two lines, counted up to `WHOLE + 1`.
fn two_lines<'b>(bytes: impl Iterator<Item = &'b u8>) -> usize {
    let mut ends = 0;
    let within = |byte: &&u8| {
        ends += usize::from(**byte == b'\n');
        ends < 2
    };
    bytes.take(WHOLE + 1).take_while(within).count()
}

/// Draws the headline and then each label with the text around it. Every line ends with a newline.
pub(crate) fn draw(finding: &Finding, sources: &SourceMap, style: Style) -> String {
    let (severity, code) = (finding.severity().as_str(), finding.code);
    let mut out = format!("{severity} {code}: {}\n", finding.message);
    for label in finding.labels.iter().filter(|label| !label.span.is_none()) {
        let name = sources.name(label.span.file);
        let at = sources.line_col(label.span);
        out.push_str(&format!(
            "  [{name}:{at}]\n{}",
            window(label, sources, style)
        ));
    }
    out
}

/// Draws the text around a label, and below it the marks with the text of the label.
fn window(label: &Label, sources: &SourceMap, style: Style) -> String {
    let text = sources.text(label.span.file);
    let (start, end) = sources.clamp(label.span);
    let dots = if style.unicode { "…" } else { "..." };
    let (before, more) = part(text[..start].chars().rev());
    let lead: String = before.chars().rev().collect();
    let lead = format!("{}{lead}", if more { dots } else { "" });
    let (here, cut) = part(text[start..end].chars());
    let (after, more) = if cut {
        (String::new(), true)
    } else {
        part(text[end..].chars())
    };
    let tail = if more { dots } else { "" };
    let indent = lead.chars().count();
    let marks = "^".repeat(here.chars().count().max(1));
    let marked = format!("    {:indent$}{marks} {}", "", label.text);
    format!("    {lead}{here}{after}{tail}\n{}\n", marked.trim_end())
}

/// Returns the next characters up to the end of the line, and whether the line continues. Control characters are
/// replaced.
fn part(chars: impl Iterator<Item = char>) -> (String, bool) {
    let mut line = chars.take_while(|c| *c != '\n');
    let shown = line.by_ref().take(AROUND).map(|c| match c {
        '\t' => ' ',
        c if c.is_control() => char::REPLACEMENT_CHARACTER,
        c => c,
    });
    let shown = shown.collect();
    (shown, line.next().is_some())
}
