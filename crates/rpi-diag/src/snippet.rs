//! Headline and source snippets of a diagnostic, drawn with miette.

use std::fmt;

use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, SourceCode};

use crate::apart::{Mark, apart};
use crate::texts::Texts;
use crate::{Finding, Severity, SourceMap, Style};

/// Draws the headline and the snippets of a diagnostic. Every line ends with a newline.
pub(crate) fn draw(finding: &Finding, sources: &SourceMap, style: Style) -> String {
    let shown = Shown {
        finding,
        texts: Texts::of(finding, sources),
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

/// Removes the indentation of the headline and trailing spaces.
fn tidy(drawn: &str) -> String {
    let drawn = drawn.strip_prefix("  ").unwrap_or(drawn);
    drawn
        .lines()
        .map(|line| format!("{}\n", line.trim_end()))
        .collect()
}

/// Returns miette's theme with the headline and the colours of this crate.
fn theme(shown: &Shown<'_>, style: Style) -> GraphicalTheme {
    let mut theme = match (style.color, style.unicode) {
        (true, true) => GraphicalTheme::unicode(),
        (true, false) => GraphicalTheme::ascii(),
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
        paint(&mut theme, shown);
    }
    theme
}

/// Sets the colours: primary labels get that of the severity, secondary labels that of help texts.
fn paint(theme: &mut GraphicalTheme, shown: &Shown<'_>) {
    let styles = &mut theme.styles;
    let fault = match shown.finding.severity() {
        Severity::Error => styles.error,
        Severity::Warning => styles.warning,
        Severity::Note => styles.advice,
    };
    styles.link = styles.help;
    // miette assigns the colours to the labels in the order of their offsets.
    let mut labels = shown.placed();
    labels.sort_by_key(|label| label.offset());
    let colors = labels
        .iter()
        .map(|l| if l.primary() { fault } else { styles.help });
    styles.highlights = colors.collect();
}

/// Adapter of a diagnostic to the trait of miette.
struct Shown<'a> {
    finding: &'a Finding,
    texts: Texts<'a>,
}

impl Shown<'_> {
    fn placed(&self) -> Vec<LabeledSpan> {
        let labels = self.finding.labels.iter();
        let marks = labels.filter_map(|label| {
            let (start, len) = self.texts.place(label.span)?;
            Some(Mark {
                range: start..start + len,
                text: label.text.clone(),
                primary: label.primary,
            })
        });
        let marks = apart(marks.collect(), |range| self.texts.of_place(range));
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
