//! Output for people: headline, snippets, help, notes and fixes.

use crate::footer;
use crate::{Diagnostic, Severity, SourceMap, Style, abbreviate, snippet};
use rpi_words::with_noun;

/// Maximum number of diagnostics that are rendered. A line of the output counts the others.
const MAX_RENDERED: usize = 100;

/// Renders diagnostics in the given order, followed by a summary of their number.
///
/// A diagnostic consists of the headline `error RPI0001: message`, the source lines with marked locations, and the
/// help. At most [`MAX_RENDERED`] diagnostics are rendered.
pub fn render(diagnostics: &[Diagnostic], sources: &SourceMap, style: Style) -> String {
    let mut out = String::new();
    for diagnostic in diagnostics.iter().take(MAX_RENDERED) {
        out.push_str(&match abbreviate::is_needed(diagnostic, sources) {
            true => abbreviate::draw(diagnostic, sources, style),
            false => snippet::draw(diagnostic, sources, style),
        });
        out.push_str(&footer::draw(diagnostic, sources, style));
        out.push('\n');
    }
    if diagnostics.len() > MAX_RENDERED {
        out.push_str(&format!(
            "and {} more\n\n",
            diagnostics.len() - MAX_RENDERED
        ));
    }
    out.push_str(&summary(diagnostics));
    out
}

/// Returns the last line of the output: the numbers of errors, warnings and notes, and how to get an explanation of
/// their codes. The line is empty if there are no diagnostics.
fn summary(diagnostics: &[Diagnostic]) -> String {
    let Some(first) = diagnostics.first() else {
        return String::new();
    };
    let count = |severity| {
        diagnostics
            .iter()
            .filter(|f| f.severity() == severity)
            .count()
    };
    let counts: Vec<String> = [Severity::Error, Severity::Warning, Severity::Note]
        .into_iter()
        .filter(|&severity| count(severity) > 0)
        .map(|severity| with_noun(count(severity), severity.as_str()))
        .collect();
    let one_code = diagnostics.iter().all(|f| f.code == first.code);
    let code = if one_code {
        first.code.as_str()
    } else {
        "CODE"
    };
    format!("{}; `rpic explain {code}` says more\n", counts.join(", "))
}
