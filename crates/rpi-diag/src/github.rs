//! Output as workflow commands of GitHub Actions, which annotate the lines of a change.
//!
//! Syntax: `::error file=..,line=..,col=..,endLine=..,endColumn=..,title=..::message`, as documented in GitHub's
//! "Workflow commands for GitHub Actions".

use crate::{Diagnostic, Severity, SourceMap};

/// Renders each diagnostic as a workflow command of GitHub Actions, such as `::error file=..,line=..::message`.
pub(crate) fn render(diagnostics: &[Diagnostic], sources: &SourceMap) -> String {
    diagnostics
        .iter()
        .map(|diagnostic| command(diagnostic, sources))
        .collect()
}

fn command(diagnostic: &Diagnostic, sources: &SourceMap) -> String {
    let level = match diagnostic.severity() {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "notice",
    };
    let mut properties = place(diagnostic, sources);
    properties.push(format!("title={}", property(diagnostic.code.as_str())));
    let message = std::iter::once(&diagnostic.message)
        .chain(&diagnostic.help)
        .cloned()
        .collect::<Vec<_>>()
        .join("\n");
    format!("::{level} {}::{}\n", properties.join(","), escape(&message))
}

fn place(diagnostic: &Diagnostic, sources: &SourceMap) -> Vec<String> {
    let span = diagnostic.span();
    let name = sources.name(span.file);
    if name.is_empty() {
        return Vec::new();
    }
    let (start, end) = (sources.line_col(span), sources.line_col_end(span));
    let mut place = vec![
        format!("file={}", property(name)),
        format!("line={}", start.line),
        format!("endLine={}", end.line),
    ];
    // GitHub accepts columns only for ranges within one line.
    if start.line == end.line {
        place.push(format!("col={}", start.col));
        place.push(format!("endColumn={}", end.col));
    }
    place
}

fn escape(text: &str) -> String {
    text.replace('%', "%25")
        .replace('\r', "%0D")
        .replace('\n', "%0A")
}

fn property(text: &str) -> String {
    escape(text).replace(':', "%3A").replace(',', "%2C")
}
