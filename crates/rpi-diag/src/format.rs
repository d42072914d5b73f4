//! The forms in which findings can be asked for.

use std::str::FromStr;

use crate::{Finding, SourceMap, Style, github, json, render, sarif};

/// A form of output for findings.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Format {
    /// For people, with snippets.
    Human,
    /// One line per finding: `file:line:col: severity CODE: message`.
    Short,
    /// All that is known, as one JSON object.
    Json,
    /// SARIF 2.1.0, as code scanners read it.
    Sarif,
    /// Workflow commands of GitHub Actions.
    Github,
}

/// The forms by name, in the order in which help texts list them.
const NAMES: [(&str, Format); 5] = [
    ("human", Format::Human),
    ("short", Format::Short),
    ("json", Format::Json),
    ("sarif", Format::Sarif),
    ("github", Format::Github),
];

impl Format {
    /// The names that [`Format::from_str`] takes.
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
            format!("no such form: {name} (there are {})", names.join(", "))
        })
    }
}

/// Renders findings in the form asked for; `style` matters to [`Format::Human`] only.
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
