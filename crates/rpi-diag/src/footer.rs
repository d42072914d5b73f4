//! Text below the snippets of a diagnostic: help, notes, and fixes with a preview of the changed lines.

use crate::{Diagnostic, Edit, Fix, SourceMap, Span, Style};

/// Draws the help, the notes and the fixes of a diagnostic, which follow its source snippets. Every line ends with a
/// newline; the result is empty if there is nothing to draw.
pub(crate) fn draw(diagnostic: &Diagnostic, sources: &SourceMap, style: Style) -> String {
    let mut out = String::new();
    for text in &diagnostic.help {
        out.push_str(&paragraph("help", text, style));
    }
    for text in &diagnostic.notes {
        out.push_str(&paragraph("note", text, style));
    }
    for fix in &diagnostic.fixes {
        out.push_str(&paragraph("fix", &fix.title, style));
        out.push_str(&preview(fix, sources, style));
    }
    out
}

/// Formats a text as `  head: text`, wrapped to the width of the style. Further lines are aligned to the text, and line
/// breaks in the text are preserved.
fn paragraph(head: &str, text: &str, style: Style) -> String {
    let indent = head.len() + 4;
    let lines = text
        .lines()
        .flat_map(|line| wrap(line, style.width.saturating_sub(indent)));
    let mut out = String::new();
    for (number, line) in lines.enumerate() {
        match number {
            0 => out.push_str(&format!("  {}: {line}\n", painted(head, "36", style))),
            _ => out.push_str(&format!("{:indent$}{line}\n", "")),
        }
    }
    out
}

/// Breaks a line at spaces into parts of at most `width` characters, unless a single word is longer. A line with
/// leading spaces (a drawing, a table) is returned unchanged.
fn wrap(line: &str, width: usize) -> Vec<String> {
    if line.starts_with(' ') {
        return vec![line.to_owned()];
    }
    let mut lines = vec![String::new()];
    for word in line.split(' ') {
        let last = lines.len() - 1;
        let current = &mut lines[last];
        if !current.is_empty() && current.chars().count() + 1 + word.chars().count() > width {
            lines.push(word.to_owned());
        } else {
            if !current.is_empty() {
                current.push(' ');
            }
            current.push_str(word);
        }
    }
    lines
}

/// Draws the source lines that a fix changes: lines after the change with `+`, and before them the old lines with `-`
/// if text is deleted or replaced.
fn preview(fix: &Fix, sources: &SourceMap, style: Style) -> String {
    let edits = fix.in_order();
    let mut out = String::new();
    let mut rest = edits.as_slice();
    while let Some(first) = rest.first() {
        let region = Region::around(first, sources);
        let count = rest
            .iter()
            .take_while(|edit| region.contains(edit))
            .count()
            .max(1);
        out.push_str(&region.draw(&rest[..count], sources, style));
        rest = &rest[count..];
    }
    out
}

/// Maximum length in bytes of the source lines around an edit that are previewed. Longer lines get no preview.
const MAX_PREVIEW_BYTES: u32 = 400;

/// Whole source lines around an edit, which the preview of a fix shows.
struct Region {
    span: Span,
    first_line: u32,
    /// True if the edit deletes all of the lines, so that the preview shows them only as removed.
    is_deleted: bool,
}

impl Region {
    fn around(edit: &Edit, sources: &SourceMap) -> Region {
        let text = sources.text(edit.span.file);
        let (start, end) = sources.clamp(edit.span);
        let start = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let whole = edit.deletes_whole_lines(text);
        let end = match whole {
            true => end - 1,
            false => text[end..].find('\n').map_or(text.len(), |at| end + at),
        };
        let span = Span::new(edit.span.file, start as u32, end as u32);
        Region {
            span,
            first_line: sources.line_col(span).line,
            is_deleted: whole,
        }
    }

    fn contains(&self, edit: &Edit) -> bool {
        edit.span.file == self.span.file
            && self.span.start <= edit.span.start
            && edit.span.end <= self.span.end
    }

    fn draw(&self, edits: &[&Edit], sources: &SourceMap, style: Style) -> String {
        if self.span.end - self.span.start > MAX_PREVIEW_BYTES {
            return String::new();
        }
        let old = sources.slice(self.span);
        let new = self.edited(edits, sources);
        let lost = edits.iter().any(|edit| !edit.span.is_empty());
        let mut out = String::new();
        if lost {
            out.push_str(&self.lines(old, '-', "31", style));
        }
        if !self.is_deleted {
            out.push_str(&self.lines(&new, '+', "32", style));
        }
        out
    }

    fn edited(&self, edits: &[&Edit], sources: &SourceMap) -> String {
        let text = sources.text(self.span.file);
        let mut at = self.span.start as usize;
        let mut out = String::new();
        for edit in edits {
            let (start, end) = sources.clamp(edit.span);
            out.push_str(text.get(at..start).unwrap_or(""));
            out.push_str(&edit.text);
            at = end.max(at);
        }
        out + &text[at.min(self.span.end as usize)..self.span.end as usize]
    }

    fn lines(&self, text: &str, sign: char, ansi: &str, style: Style) -> String {
        let numbered = text.split('\n').zip(self.first_line..);
        let lines = numbered.map(|(line, number)| {
            painted(&format!("       {number} {sign} {line}"), ansi, style) + "\n"
        });
        lines.collect()
    }
}

fn painted(text: &str, ansi: &str, style: Style) -> String {
    if style.color {
        format!("\u{1b}[{ansi}m{text}\u{1b}[0m")
    } else {
        text.to_owned()
    }
}
