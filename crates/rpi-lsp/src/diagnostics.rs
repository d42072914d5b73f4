//! Conversion of compiler diagnostics to diagnostics of the protocol.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use lsp_types::{
    CodeDescription, Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag,
    NumberOrString,
};
use rpi_diag::{Code, Finding, Severity};
use rpi_driver::Inspected;

use crate::places::Places;
use crate::world::World;
use crate::{shelf, uri};

/// Returns the diagnostics of a program by file. The root file is always included.
pub(crate) fn by_file(
    world: &World,
    seen: &Inspected,
    root: &Path,
) -> BTreeMap<PathBuf, Vec<Diagnostic>> {
    let places = world.places(seen);
    let mut found = BTreeMap::from([(root.to_owned(), Vec::new())]);
    for finding in &seen.findings {
        let file: &mut Vec<_> = found.entry(places.file(finding.span())).or_default();
        file.push(diagnostic(world, &places, finding));
    }
    found
}

fn diagnostic(world: &World, places: &Places<'_>, finding: &Finding) -> Diagnostic {
    let labels = finding.labels.iter().filter(|label| !label.text.is_empty());
    let related = labels.filter_map(|label| {
        Some(DiagnosticRelatedInformation {
            location: places.location(world, label.span)?,
            message: label.text.clone(),
        })
    });
    Diagnostic {
        range: places.range(finding.span()),
        severity: Some(severity(finding.severity())),
        code: Some(NumberOrString::String(finding.code.to_string())),
        code_description: page(finding.code),
        source: Some("rpic".to_owned()),
        message: message(finding),
        related_information: Some(related.collect()),
        tags: finding
            .code
            .is_about_needless_text()
            .then(|| vec![DiagnosticTag::UNNECESSARY]),
        data: None,
    }
}

/// Returns the message, followed by help texts and notes, one per line.
fn message(finding: &Finding) -> String {
    let help = finding.help.iter().map(|text| format!("\nhelp: {text}"));
    let notes = finding.notes.iter().map(|text| format!("\nnote: {text}"));
    let more: String = help.chain(notes).collect();
    format!("{}{more}", finding.message)
}

fn severity(severity: Severity) -> DiagnosticSeverity {
    match severity {
        Severity::Error => DiagnosticSeverity::ERROR,
        Severity::Warning => DiagnosticSeverity::WARNING,
        Severity::Note => DiagnosticSeverity::INFORMATION,
    }
}

/// Returns the link to the page of a code, with the text that `rpic explain` prints.
fn page(code: Code) -> Option<CodeDescription> {
    let href = uri::uri_of(&shelf::page_of(code)?)?;
    Some(CodeDescription { href })
}
