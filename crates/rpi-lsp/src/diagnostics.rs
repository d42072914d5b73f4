//! Conversion of compiler diagnostics to diagnostics of the protocol.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use lsp_types::{
    CodeDescription, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag,
    NumberOrString,
};
use rpi_diag::{Code, Severity};
use rpi_driver::Inspection;

use crate::locations::LocationMap;
use crate::workspace::Workspace;
use crate::{builtin_documents, uri};

/// Returns the diagnostics of a program in the form of the protocol, by file. The root file of the program is always
/// included, with an empty list if there are no diagnostics about it.
pub(crate) fn by_file(
    world: &Workspace,
    seen: &Inspection,
    root: &Path,
) -> BTreeMap<PathBuf, Vec<lsp_types::Diagnostic>> {
    let places = world.locations(seen);
    let mut found = BTreeMap::from([(root.to_owned(), Vec::new())]);
    for diagnostic in &seen.diagnostics {
        let file: &mut Vec<_> = found.entry(places.file(diagnostic.span())).or_default();
        file.push(to_lsp(world, &places, diagnostic));
    }
    found
}

fn to_lsp(
    world: &Workspace,
    places: &LocationMap<'_>,
    diagnostic: &rpi_diag::Diagnostic,
) -> lsp_types::Diagnostic {
    let labels = diagnostic
        .labels
        .iter()
        .filter(|label| !label.text.is_empty());
    let related = labels.filter_map(|label| {
        Some(DiagnosticRelatedInformation {
            location: places.location(world, label.span)?,
            message: label.text.clone(),
        })
    });
    lsp_types::Diagnostic {
        range: places.range(diagnostic.span()),
        severity: Some(severity(diagnostic.severity())),
        code: Some(NumberOrString::String(diagnostic.code.to_string())),
        code_description: code_description(diagnostic.code),
        source: Some("rpic".to_owned()),
        message: message(diagnostic),
        related_information: Some(related.collect()),
        tags: diagnostic
            .code
            .is_unnecessary()
            .then(|| vec![DiagnosticTag::UNNECESSARY]),
        data: None,
    }
}

/// Returns the message of a diagnostic, followed by its help texts and notes, one per line.
fn message(diagnostic: &rpi_diag::Diagnostic) -> String {
    let help = diagnostic.help.iter().map(|text| format!("\nhelp: {text}"));
    let notes = diagnostic
        .notes
        .iter()
        .map(|text| format!("\nnote: {text}"));
    let more: String = help.chain(notes).collect();
    format!("{}{more}", diagnostic.message)
}

fn severity(severity: Severity) -> DiagnosticSeverity {
    match severity {
        Severity::Error => DiagnosticSeverity::ERROR,
        Severity::Warning => DiagnosticSeverity::WARNING,
        Severity::Note => DiagnosticSeverity::INFORMATION,
    }
}

/// Returns the link to the explanation page of a diagnostic code, with the text that `rpic explain` prints; `None` if
/// the page cannot be written to the cache.
fn code_description(code: Code) -> Option<CodeDescription> {
    let href = uri::from_path(&builtin_documents::code_page_path(code)?)?;
    Some(CodeDescription { href })
}
