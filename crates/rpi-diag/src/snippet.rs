//! The source snippets of a finding, drawn by miette.
//!
//! miette knows one text per diagnostic. Here the files of a finding lie one after another in one
//! address space, the file of the fault first; a range that crosses files cannot be read, and so
//! miette draws one snippet per file.

use std::fmt;

use miette::{
    Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, MietteError,
    MietteSpanContents, SourceCode, SourceSpan, SpanContents,
};

use crate::{FileId, Finding, Severity, SourceMap, Span, Style};

/// The headline and the snippets of a finding, each line ended.
pub(crate) fn draw(finding: &Finding, sources: &SourceMap, style: Style) -> String {
    let shown = Shown {
        finding,
        texts: Texts::of(finding, sources),
    };
    let mut out = String::new();
    let handler = GraphicalReportHandler::new_themed(theme(&shown, style))
        .with_links(false)
        .with_width(style.width)
        .with_break_words(false)
        .with_context_lines(1)
        .without_syntax_highlighting();
    // Writing to a string does not fail, and the ranges were clamped to the text.
    let _ = handler.render_report(&mut out, &shown);
    out
}

/// Our colours: the fault in the colour of its severity, what has to do with it in blue.
fn theme(shown: &Shown<'_>, style: Style) -> GraphicalTheme {
    let mut theme = match (style.color, style.unicode) {
        (true, true) => GraphicalTheme::unicode(),
        (true, false) => GraphicalTheme {
            styles: miette::ThemeStyles::ansi(),
            ..GraphicalTheme::ascii()
        },
        (false, true) => GraphicalTheme::unicode_nocolor(),
        (false, false) => GraphicalTheme::none(),
    };
    let headline = format!(
        "{} {}:",
        shown.finding.severity().as_str(),
        shown.finding.code
    );
    theme.characters.error = headline.clone();
    theme.characters.warning = headline.clone();
    theme.characters.advice = headline;
    if style.color {
        let styles = &theme.styles;
        let fault = match shown.finding.severity() {
            Severity::Error => styles.error,
            Severity::Warning => styles.warning,
            Severity::Note => styles.advice,
        };
        let other = styles.link;
        let mut labels = shown.placed();
        labels.sort_by_key(|label| label.offset());
        theme.styles.highlights = labels
            .iter()
            .map(|l| if l.primary() { fault } else { other })
            .collect();
        if theme.styles.highlights.is_empty() {
            theme.styles.highlights.push(fault);
        }
    }
    theme
}

/// A finding as miette wants to see it.
struct Shown<'a> {
    finding: &'a Finding,
    texts: Texts<'a>,
}

impl Shown<'_> {
    fn placed(&self) -> Vec<LabeledSpan> {
        let labels = self.finding.labels.iter();
        labels
            .filter_map(|label| {
                let (start, len) = self.texts.place(label.span)?;
                let text = (!label.text.is_empty()).then(|| label.text.clone());
                Some(if label.primary {
                    LabeledSpan::new_primary_with_span(text, (start, len))
                } else {
                    LabeledSpan::new_with_span(text, (start, len))
                })
            })
            .collect()
    }
}

impl fmt::Debug for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.finding.fmt(f)
    }
}

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.finding.message)
    }
}

impl std::error::Error for Shown<'_> {}

impl Diagnostic for Shown<'_> {
    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.finding.severity() {
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
            Severity::Note => miette::Severity::Advice,
        })
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.texts)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.placed().into_iter()))
    }
}

/// The texts of a finding's files, one after another with a gap of one.
struct Texts<'a> {
    sources: &'a SourceMap,
    /// File and address of its first byte.
    files: Vec<(FileId, usize)>,
}

impl<'a> Texts<'a> {
    fn of(finding: &Finding, sources: &'a SourceMap) -> Texts<'a> {
        let mut files: Vec<(FileId, usize)> = Vec::new();
        let mut next = 0;
        let spans =
            std::iter::once(finding.span()).chain(finding.labels.iter().map(|label| label.span));
        for Span { file, .. } in spans.filter(|span| !span.is_none()) {
            if files.iter().all(|&(known, _)| known != file) {
                files.push((file, next));
                next += sources.text(file).len() + 1;
            }
        }
        Texts { sources, files }
    }

    /// Address and length of a range; nothing for a place without text.
    fn place(&self, span: Span) -> Option<(usize, usize)> {
        let &(_, base) = self.files.iter().find(|&&(file, _)| file == span.file)?;
        let (start, end) = self.sources.clamp(span);
        Some((base + start, end - start))
    }
}

impl SourceCode for Texts<'_> {
    fn read_span<'b>(
        &'b self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'b> + 'b>, MietteError> {
        let found = self
            .files
            .iter()
            .rev()
            .find(|&&(_, base)| base <= span.offset());
        let &(file, base) = found.ok_or(MietteError::OutOfBounds)?;
        let local = SourceSpan::from((span.offset() - base, span.len()));
        let contents = self.sources.text(file).read_span(&local, before, after)?;
        Ok(Box::new(MietteSpanContents::new_named(
            self.sources.name(file).to_owned(),
            contents.data(),
            SourceSpan::from((contents.span().offset() + base, contents.span().len())),
            contents.line(),
            contents.column(),
            contents.line_count(),
        )))
    }
}
