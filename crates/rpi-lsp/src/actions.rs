//! Code actions: one for each fix of a diagnostic in the requested range, and one that applies all sure fixes.

use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;

use lsp_types::{
    CodeAction, CodeActionKind, CodeActionParams, CodeActionResponse, DocumentChanges, OneOf,
    OptionalVersionedTextDocumentIdentifier, Range, TextDocumentEdit, TextEdit, WorkspaceEdit,
};
use rpi_diag::{Applicability, Edit, Finding, Fix};

use crate::client::FIX_ALL;
use crate::places::Places;
use crate::world::World;

/// Handles `textDocument/codeAction`.
pub(crate) fn actions(world: &mut World, params: CodeActionParams) -> Option<CodeActionResponse> {
    let uri = params.text_document.uri;
    let seen = world.see(&uri)?;
    let places = world.places(&seen);
    let here = places.file(rpi_diag::Span::NONE);
    let asked = |finding: &&Finding| {
        let span = finding.span();
        places.file(span) == here && touches(places.range(span), params.range)
    };
    let findings: Vec<&Finding> = seen.findings.iter().filter(asked).collect();
    let mut actions = Vec::new();
    for finding in findings {
        for fix in &finding.fixes {
            actions.push(quick_fix(world, &places, finding, fix));
        }
    }
    let edits = rpi_diag::sure_edits(&seen.findings);
    if !edits.is_empty() {
        actions.push(CodeAction {
            title: "apply all sure fixes".to_owned(),
            kind: Some(FIX_ALL),
            edit: Some(workspace_edit(world, &places, &edits)),
            ..CodeAction::default()
        });
    }
    let wanted = |action: &CodeAction| is_wanted(params.context.only.as_deref(), action);
    Some(actions.into_iter().filter(wanted).map(Into::into).collect())
}

fn quick_fix(world: &World, places: &Places<'_>, finding: &Finding, fix: &Fix) -> CodeAction {
    CodeAction {
        title: format!("{} ({})", fix.title, finding.code),
        kind: Some(CodeActionKind::QUICKFIX),
        edit: Some(workspace_edit(world, places, &fix.edits)),
        is_preferred: Some(fix.applicability == Applicability::Sure),
        ..CodeAction::default()
    }
}

/// Returns whether the client requested this kind of action. Kinds are hierarchical: `source` includes
/// `source.fixAll.rpi`.
fn is_wanted(only: Option<&[CodeActionKind]>, action: &CodeAction) -> bool {
    let kind = action.kind.as_ref().map_or("", |kind| kind.as_str());
    let covers = |wanted: &CodeActionKind| {
        let rest = kind.strip_prefix(wanted.as_str());
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    only.is_none_or(|only| only.iter().any(covers))
}

fn touches(a: Range, b: Range) -> bool {
    a.start <= b.end && b.start <= a.end
}

fn workspace_edit(world: &World, places: &Places<'_>, edits: &[Edit]) -> WorkspaceEdit {
    let mut files: BTreeMap<PathBuf, Vec<TextEdit>> = BTreeMap::new();
    for edit in edits {
        let of_file = files.entry(places.file(edit.span)).or_default();
        of_file.push(TextEdit::new(places.range(edit.span), edit.text.clone()));
    }
    match world.client.versioned_edits {
        true => versioned(world, files),
        false => plain(world, files),
    }
}

/// Creates edits with document versions. The client rejects them for any other version.
fn versioned(world: &World, files: BTreeMap<PathBuf, Vec<TextEdit>>) -> WorkspaceEdit {
    let edit = |(path, edits): (PathBuf, Vec<TextEdit>)| {
        Some(TextDocumentEdit {
            text_document: OptionalVersionedTextDocumentIdentifier {
                uri: world.uri_of(&path)?,
                version: world.version_of(&path),
            },
            edits: edits.into_iter().map(OneOf::Left).collect(),
        })
    };
    let edits = files.into_iter().filter_map(edit).collect();
    WorkspaceEdit {
        document_changes: Some(DocumentChanges::Edits(edits)),
        ..WorkspaceEdit::default()
    }
}

// The type is given by the protocol, and its keys are never mutated.
#[allow(clippy::mutable_key_type)]
fn plain(world: &World, files: BTreeMap<PathBuf, Vec<TextEdit>>) -> WorkspaceEdit {
    let edit = |(path, edits): (PathBuf, Vec<TextEdit>)| Some((world.uri_of(&path)?, edits));
    let changes: HashMap<_, _> = files.into_iter().filter_map(edit).collect();
    WorkspaceEdit {
        changes: Some(changes),
        ..WorkspaceEdit::default()
    }
}
