//! Output for people: headline, snippets, help, notes and fixes.

use crate::footer;
use crate::{Finding, Severity, SourceMap, Style, cut, snippet};
use rpi_words::counted;

/// Largest number of diagnostics that are rendered; the summary counts the others.
const MOST: usize = 100;

/// Renders diagnostics in the given order, followed by a summary of their number.
///
/// A diagnostic consists of the headline `error RPI0001: message`, the source lines with marked locations, and the
/// help. At most [`MOST`] diagnostics are rendered.
pub fn render(findings: &[Finding], sources: &SourceMap, style: Style) -> String {
    let mut out = String::new();
    for finding in findings.iter().take(MOST) {
        out.push_str(&match cut::is_needed(finding, sources) {
            true => cut::draw(finding, sources, style),
            false => snippet::draw(finding, sources, style),
        });
        out.push_str(&footer::draw(finding, sources, style));
        out.push('\n');
    }
    if findings.len() > MOST {
        out.push_str(&format!("and {} more\n\n", findings.len() - MOST));
    }
    out.push_str(&summary(findings));
    out
}

/// Returns `2 errors, 1 warning; ...` and how to get an explanation; empty if there are no diagnostics.
fn summary(findings: &[Finding]) -> String {
    let Some(first) = findings.first() else {
        return String::new();
    };
    let count = |severity| findings.iter().filter(|f| f.severity() == severity).count();
    let counts: Vec<String> = [Severity::Error, Severity::Warning, Severity::Note]
        .into_iter()
        .filter(|&severity| count(severity) > 0)
        .map(|severity| counted(count(severity), severity.as_str()))
        .collect();
    let one_code = findings.iter().all(|f| f.code == first.code);
    let code = if one_code {
        first.code.as_str()
    } else {
        "CODE"
    };
    format!("{}; `rpic explain {code}` says more\n", counts.join(", "))
}
