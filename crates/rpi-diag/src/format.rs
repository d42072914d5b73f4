//! Output formats of diagnostics.

use std::str::FromStr;

use crate::{Finding, SourceMap, Style, github, json, render, sarif};

/// Output format of diagnostics.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Format {
    /// Text with source snippets, for people.
    Human,
    /// One line per diagnostic: `file:line:col: severity CODE: message`.
    Short,
    /// One JSON object with all details.
    Json,
    /// SARIF 2.1.0, read by code scanners.
    Sarif,
    /// Workflow commands of GitHub Actions.
    Github,
}

/// Formats by name, in the order of the help texts.
const NAMES: [(&str, Format); 5] = [
    ("human", Format::Human),
    ("short", Format::Short),
    ("json", Format::Json),
    ("sarif", Format::Sarif),
    ("github", Format::Github),
];

impl Format {
    /// Returns the names that [`Format::from_str`] accepts.
    pub fn names() -> impl Iterator<Item = &'static str> {
        NAMES.iter().map(|(name, _)| *name)
    }
}

impl FromStr for Format {
    type Err = String;

    fn from_str(name: &str) -> Result<Format, String> {
        let found = NAMES.iter().find(|(known, _)| *known == name);
        found.map(|(_, format)| *format).ok_or_else(|| {
            let names: Vec<&str> = Format::names().collect();
            format!(
                "unknown format: {name} (expected one of {})",
                names.join(", ")
            )
        })
    }
}

/// Renders diagnostics in the given format; `style` applies to [`Format::Human`] only.
pub fn render_as(
    format: Format,
    findings: &[Finding],
    sources: &SourceMap,
    style: Style,
) -> String {
    match format {
        Format::Human => render(findings, sources, style),
        Format::Short => short(findings, sources),
        Format::Json => json::render(findings, sources),
        Format::Sarif => sarif::render(findings, sources),
        Format::Github => github::render(findings, sources),
    }
}

fn short(findings: &[Finding], sources: &SourceMap) -> String {
    findings
        .iter()
        .map(|finding| short_line(finding, sources))
        .collect()
}

fn short_line(finding: &Finding, sources: &SourceMap) -> String {
    let span = finding.span();
    let place = match sources.name(span.file) {
        "" => String::new(),
        name => format!("{name}:{}: ", sources.line_col(span)),
    };
    let message = finding.message.replace('\n', " ");
    format!(
        "{place}{} {}: {message}\n",
        finding.severity().as_str(),
        finding.code
    )
}
