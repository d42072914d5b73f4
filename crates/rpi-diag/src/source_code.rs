//! Source texts of a diagnostic in one address space, as miette requires.
//!
//! The files follow one another with a gap of one byte, the file of the error first. A range that crosses files cannot
//! be read, so miette draws one snippet per file. `SourceCode` is implemented here instead of using miette's
//! `NamedSource`, because that counts columns in bytes and joins distant snippets of long files.

use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};

use crate::{Diagnostic, FileId, SourceMap, Span};

/// Maximum number of lines between two labels that are drawn in one snippet. Labels farther apart get separate
/// snippets.
const MAX_LINE_GAP: usize = 2;

/// Source texts of one diagnostic, joined to a single text with common byte addresses, as the drawing library miette
/// requires.
pub(crate) struct DiagnosticSources<'a> {
    sources: &'a SourceMap,
    /// Files of the diagnostic, each with the address of its first byte in the joined text.
    files: Vec<(FileId, usize)>,
    /// Location of the error, for which miette prints the line and column.
    error_span: Span,
}

impl<'a> DiagnosticSources<'a> {
    pub(crate) fn for_diagnostic(
        diagnostic: &Diagnostic,
        sources: &'a SourceMap,
    ) -> DiagnosticSources<'a> {
        let mut files: Vec<(FileId, usize)> = Vec::new();
        let mut next = 0;
        let spans = std::iter::once(diagnostic.span())
            .chain(diagnostic.labels.iter().map(|label| label.span));
        for Span { file, .. } in spans.filter(|span| !span.is_none()) {
            if files.iter().all(|&(known, _)| known != file) {
                files.push((file, next));
                next += sources.text(file).len() + 1;
            }
        }
        DiagnosticSources {
            sources,
            files,
            error_span: diagnostic.span(),
        }
    }

    /// Returns the address in the joined text and the length of a range in bytes, or `None` for a range without source
    /// text. A start at the end of the file is mapped to the position after its last visible character, because miette
    /// draws no line for trailing blank text.
    pub(crate) fn address_range(&self, span: Span) -> Option<(usize, usize)> {
        let &(_, base) = self.files.iter().find(|&&(file, _)| file == span.file)?;
        let (start, end) = self.sources.clamp(span);
        let text = self.sources.text(span.file);
        let start = if start == text.len() {
            text.trim_end().len()
        } else {
            start
        };
        Some((base + start, end - start.min(end)))
    }

    /// Returns the source text of a range of addresses in the joined text; empty if the range is not within one file.
    pub(crate) fn text(&self, range: std::ops::Range<usize>) -> &'a str {
        let place = self.find(range.start).and_then(|(file, base)| {
            let text = self.sources.text(file);
            text.get(range.start - base..range.end - base)
        });
        place.unwrap_or_default()
    }

    fn find(&self, address: usize) -> Option<(FileId, usize)> {
        self.files
            .iter()
            .rev()
            .find(|&&(_, base)| base <= address)
            .copied()
    }
}

impl SourceCode for DiagnosticSources<'_> {
    fn read_span<'b>(
        &'b self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'b> + 'b>, MietteError> {
        let (file, base) = self.find(span.offset()).ok_or(MietteError::OutOfBounds)?;
        let text = self.sources.text(file);
        let start = span.offset() - base;
        let end = start + span.len();
        if end > text.len() {
            return Err(MietteError::OutOfBounds);
        }
        let from = (0..before).fold(line_start(text, start), |at, _| previous_line(text, at));
        let last = end.saturating_sub(usize::from(end > start));
        let to = (0..after).fold(line_end(text, last), |at, _| next_line_end(text, at));
        // Without context, miette requests the label itself, to print its line and column.
        let from = if before == 0 { start } else { from };
        let line_col = |from| self.sources.line_col(Span::new(file, from, from));
        let (drawn, fault) = (line_col(from as u32), line_col(self.error_span.start));
        // The mark of the error may begin at a later column, because it was shortened beside a mark within it.
        let is_fault = before == 0 && file == self.error_span.file && drawn.line == fault.line;
        let at = if is_fault { fault } else { drawn };
        Ok(Box::new(MietteSpanContents::new_named(
            self.sources.name(file).to_owned(),
            &text.as_bytes()[from..to],
            SourceSpan::from((base + from, to - from)),
            at.line as usize - 1,
            at.col as usize - 1,
            text[from..to].lines().count() + MAX_LINE_GAP,
        )))
    }
}

fn line_start(text: &str, at: usize) -> usize {
    text[..at].rfind('\n').map_or(0, |newline| newline + 1)
}

/// Returns the offset after the end of the line that contains `at`, including its line break.
fn line_end(text: &str, at: usize) -> usize {
    text.as_bytes()[at..]
        .iter()
        .position(|&b| b == b'\n')
        .map_or(text.len(), |newline| at + newline + 1)
}

/// Returns the start of the line before the line that starts at `start`, or `start` if that previous line is blank.
fn previous_line(text: &str, start: usize) -> usize {
    let previous = line_start(text, start.saturating_sub(1));
    if text[previous..start].trim().is_empty() {
        start
    } else {
        previous
    }
}

/// Returns the end of the line after the line that ends at `end`, or `end` if that next line is blank.
fn next_line_end(text: &str, end: usize) -> usize {
    let next = line_end(text, end);
    if text[end..next].trim().is_empty() {
        end
    } else {
        next
    }
}
