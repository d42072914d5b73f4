//! Headline and source snippets of a diagnostic, drawn with miette.

use std::fmt;

use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, SourceCode};

use crate::overlap::{Mark, separate_labels};
use crate::source_code::DiagnosticSources;
use crate::{Diagnostic, Severity, SourceMap, Style};

/// Draws the headline and the source snippets of a diagnostic. Every line ends with a newline.
pub(crate) fn draw(diagnostic: &Diagnostic, sources: &SourceMap, style: Style) -> String {
    let shown = MietteDiagnostic {
        diagnostic,
        texts: DiagnosticSources::for_diagnostic(diagnostic, sources),
    };
    let mut out = String::new();
    // No hyperlinks, because not every terminal supports the escape sequence (OSC 8).
    let handler = GraphicalReportHandler::new_themed(theme(&shown, style))
        .with_links(false)
        .with_width(style.width)
        .with_break_words(false)
        .with_context_lines(1)
        .without_syntax_highlighting();
    // Writing to a string does not fail, and all ranges are within the text because they were clamped.
    let _ = handler.render_report(&mut out, &shown);
    tidy(&out)
}

/// Removes the indentation of the headline, and trailing spaces, from a drawn snippet.
fn tidy(drawn: &str) -> String {
    let drawn = drawn.strip_prefix("  ").unwrap_or(drawn);
    drawn
        .lines()
        .map(|line| format!("{}\n", line.trim_end()))
        .collect()
}

/// Returns the drawing theme of the library miette, with the headline and the colours of this crate.
fn theme(shown: &MietteDiagnostic<'_>, style: Style) -> GraphicalTheme {
    let mut theme = match (style.color, style.unicode) {
        (true, true) => GraphicalTheme::unicode(),
        (true, false) => GraphicalTheme::ascii(),
        (false, true) => GraphicalTheme::unicode_nocolor(),
        (false, false) => GraphicalTheme::none(),
    };
    let headline = format!(
        "{} {}:",
        shown.diagnostic.severity().as_str(),
        shown.diagnostic.code
    );
    theme.characters.error = headline.clone();
    theme.characters.warning = headline.clone();
    theme.characters.advice = headline;
    if style.color {
        paint(&mut theme, shown);
    }
    theme
}

/// Sets the colours of the labels: primary labels get the colour of the severity, secondary labels the colour of help
/// texts.
fn paint(theme: &mut GraphicalTheme, shown: &MietteDiagnostic<'_>) {
    let styles = &mut theme.styles;
    let fault = match shown.diagnostic.severity() {
        Severity::Error => styles.error,
        Severity::Warning => styles.warning,
        Severity::Note => styles.advice,
    };
    styles.link = styles.help;
    // miette assigns the colours to the labels in the order of their offsets.
    let mut labels = shown.labeled_spans();
    labels.sort_by_key(|label| label.offset());
    let colors = labels
        .iter()
        .map(|l| if l.primary() { fault } else { styles.help });
    styles.highlights = colors.collect();
}

/// Adapter that presents a diagnostic to the drawing library miette.
struct MietteDiagnostic<'a> {
    diagnostic: &'a Diagnostic,
    texts: DiagnosticSources<'a>,
}

impl MietteDiagnostic<'_> {
    fn labeled_spans(&self) -> Vec<LabeledSpan> {
        let labels = self.diagnostic.labels.iter();
        let marks = labels.filter_map(|label| {
            let (start, len) = self.texts.address_range(label.span)?;
            Some(Mark {
                range: start..start + len,
                text: label.text.clone(),
                primary: label.primary,
            })
        });
        let marks = separate_labels(marks.collect(), |range| self.texts.text(range));
        let labels = marks.into_iter().map(|mark| {
            let text = Some(mark.text).filter(|text| !text.is_empty());
            let place = (mark.range.start, mark.range.len());
            match mark.primary {
                true => LabeledSpan::new_primary_with_span(text, place),
                false => LabeledSpan::new_with_span(text, place),
            }
        });
        labels.collect()
    }
}

impl fmt::Debug for MietteDiagnostic<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.diagnostic.fmt(f)
    }
}

impl fmt::Display for MietteDiagnostic<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.diagnostic.message)
    }
}

impl std::error::Error for MietteDiagnostic<'_> {}

impl miette::Diagnostic for MietteDiagnostic<'_> {
    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.diagnostic.severity() {
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
            Severity::Note => miette::Severity::Advice,
        })
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.texts)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.labeled_spans().into_iter()))
    }
}
