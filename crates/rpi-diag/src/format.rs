//! Output formats of diagnostics.

use std::fmt;
use std::str::FromStr;

use crate::{Diagnostic, SourceMap, Style, github, json, render, sarif};

/// Format in which diagnostics are printed: text for people, or a format for tools.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Format {
    /// Text with source snippets for people, drawn for a terminal.
    Human,
    /// One line for each diagnostic: `file:line:col: severity CODE: message`.
    Short,
    /// One JSON object for all diagnostics with all their details.
    Json,
    /// SARIF 2.1.0, the format of code scanners.
    Sarif,
    /// Workflow commands of GitHub Actions, which annotate the lines of a change.
    Github,
}

/// Formats with the names that select them on the command line, in the order of the help texts.
const NAMES: [(&str, Format); 5] = [
    ("human", Format::Human),
    ("short", Format::Short),
    ("json", Format::Json),
    ("sarif", Format::Sarif),
    ("github", Format::Github),
];

impl Format {
    /// Returns the names of all formats, as [`Format::from_str`] accepts them.
    pub fn names() -> impl Iterator<Item = &'static str> {
        NAMES.iter().map(|(name, _)| *name)
    }
}

/// Error: there is no output format of the requested name. The text lists the known names.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct FormatError(String);

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for FormatError {}

impl FromStr for Format {
    type Err = FormatError;

    fn from_str(name: &str) -> Result<Format, FormatError> {
        let found = NAMES.iter().find(|(known, _)| *known == name);
        found.map(|(_, format)| *format).ok_or_else(|| {
            let names: Vec<&str> = Format::names().collect();
            FormatError(format!(
                "unknown format: {name} (expected one of {})",
                names.join(", ")
            ))
        })
    }
}

/// Renders diagnostics in the given format. `style` (colours, width) applies to [`Format::Human`] only.
pub fn render_as(
    format: Format,
    diagnostics: &[Diagnostic],
    sources: &SourceMap,
    style: Style,
) -> String {
    match format {
        Format::Human => render(diagnostics, sources, style),
        Format::Short => short(diagnostics, sources),
        Format::Json => json::render(diagnostics, sources),
        Format::Sarif => sarif::render(diagnostics, sources),
        Format::Github => github::render(diagnostics, sources),
    }
}

fn short(diagnostics: &[Diagnostic], sources: &SourceMap) -> String {
    diagnostics
        .iter()
        .map(|diagnostic| short_line(diagnostic, sources))
        .collect()
}

fn short_line(diagnostic: &Diagnostic, sources: &SourceMap) -> String {
    let span = diagnostic.span();
    let place = match sources.name(span.file) {
        "" => String::new(),
        name => format!("{name}:{}: ", sources.line_col(span)),
    };
    let message = diagnostic.message.replace('\n', " ");
    format!(
        "{place}{} {}: {message}\n",
        diagnostic.severity().as_str(),
        diagnostic.code
    )
}
