//! Diagnostics that the client requests: of a document, and of all programs of the project.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

use lsp_types::{
    Diagnostic, DocumentDiagnosticParams, DocumentDiagnosticReport, DocumentDiagnosticReportResult,
    FullDocumentDiagnosticReport, RelatedFullDocumentDiagnosticReport,
    RelatedUnchangedDocumentDiagnosticReport, UnchangedDocumentDiagnosticReport,
    WorkspaceDiagnosticParams, WorkspaceDiagnosticReport, WorkspaceDiagnosticReportResult,
    WorkspaceDocumentDiagnosticReport, WorkspaceFullDocumentDiagnosticReport,
    WorkspaceUnchangedDocumentDiagnosticReport,
};

use crate::workspace::Workspace;
use crate::{diagnostics, uri};

/// Handles `textDocument/diagnostic`: returns the diagnostics about a document, or that they are the same as those of the
/// previous result that the client names.
pub(crate) fn document(
    world: &mut Workspace,
    params: DocumentDiagnosticParams,
) -> DocumentDiagnosticReportResult {
    let path = uri::to_path(&params.text_document.uri);
    let items = diagnostics_of(world, &path).unwrap_or_default();
    let result_id = identity(&items);
    let report = match params.previous_result_id.as_ref() == Some(&result_id) {
        true => DocumentDiagnosticReport::Unchanged(RelatedUnchangedDocumentDiagnosticReport {
            related_documents: None,
            unchanged_document_diagnostic_report: UnchangedDocumentDiagnosticReport { result_id },
        }),
        false => DocumentDiagnosticReport::Full(RelatedFullDocumentDiagnosticReport {
            related_documents: None,
            full_document_diagnostic_report: FullDocumentDiagnosticReport {
                result_id: Some(result_id),
                items,
            },
        }),
    };
    report.into()
}

/// Handles `workspace/diagnostic`: returns the diagnostics about every program of the project, also of closed files.
pub(crate) fn workspace(
    world: &mut Workspace,
    params: WorkspaceDiagnosticParams,
) -> WorkspaceDiagnosticReportResult {
    let near = world.open_paths().into_iter().next().unwrap_or_default();
    let mut items = Vec::new();
    let programs = world.programs(&near);
    let all = programs.len();
    for (done, path) in programs.into_iter().enumerate() {
        if !world.goes_on(done, all) {
            break;
        }
        let Some(uri) = world.uri_of(&path) else {
            continue;
        };
        let previous = params.previous_result_ids.iter().find(|one| one.uri == uri);
        let previous = previous.map(|one| one.value.as_str());
        items.extend(workspace_report(world, &path, uri, previous));
    }
    WorkspaceDiagnosticReport { items }.into()
}

fn workspace_report(
    world: &mut Workspace,
    path: &Path,
    uri: lsp_types::Uri,
    previous: Option<&str>,
) -> Option<WorkspaceDocumentDiagnosticReport> {
    let items = diagnostics_of(world, path)?;
    let version = world.version_of(path).map(i64::from);
    let result_id = identity(&items);
    Some(match previous == Some(result_id.as_str()) {
        true => WorkspaceUnchangedDocumentDiagnosticReport {
            uri,
            version,
            unchanged_document_diagnostic_report: UnchangedDocumentDiagnosticReport { result_id },
        }
        .into(),
        false => WorkspaceFullDocumentDiagnosticReport {
            uri,
            version,
            full_document_diagnostic_report: FullDocumentDiagnosticReport {
                result_id: Some(result_id),
                items,
            },
        }
        .into(),
    })
}

/// Returns the diagnostics of a program about its root file; `None` if the file cannot be read.
fn diagnostics_of(world: &mut Workspace, path: &Path) -> Option<Vec<Diagnostic>> {
    let seen = world.inspect_path(path)?;
    diagnostics::by_file(world, &seen, path).remove(path)
}

/// Returns a text that identifies a list of diagnostics.
fn identity(items: &[Diagnostic]) -> String {
    let mut hasher = DefaultHasher::new();
    let text = serde_json::to_string(items).unwrap_or_default();
    text.hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}
