//! Findings for people: headline, snippets, then help, notes and fixes.

use crate::footer;
use crate::{Finding, Severity, SourceMap, Style, cut, snippet};
use rpi_words::counted;

/// Findings that are shown; whoever has more reads the others once these are mended.
const MOST: usize = 100;

/// Renders findings one after another, and says at the end how many there were.
///
/// One finding reads: `error RPI0001: what is wrong`, the lines of source with the places marked,
/// then what to do. The order is the caller's. Of very many findings the first are shown.
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

/// `2 errors, 1 warning; ...` and where to read more; nothing for no findings.
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
