//! Code actions: one for each fix of a diagnostic in the requested range, and one that applies all sure fixes.

use std::collections::BTreeMap;
use std::path::PathBuf;

use lsp_types::{
    CodeAction, CodeActionKind, CodeActionParams, CodeActionResponse, Range, TextEdit,
    WorkspaceEdit,
};
use rpi_diag::{Applicability, Diagnostic, Edit, FileId, Fix, Span};

use crate::capabilities::FIX_ALL;
use crate::locations::LocationMap;
use crate::workspace::Workspace;
use crate::{refactor, uri};

/// Handles `textDocument/codeAction`: returns an action for each fix of the diagnostics in the requested range, and one
/// that applies all sure fixes. Returns `None` if the document is not open.
pub(crate) fn code_actions(
    world: &mut Workspace,
    params: CodeActionParams,
) -> Option<CodeActionResponse> {
    let uri = params.text_document.uri;
    let seen = world.analysis(&uri)?;
    let places = world.locations(&seen);
    let here = places.file(rpi_diag::Span::NONE);
    let in_range = |diagnostic: &&Diagnostic| {
        let span = diagnostic.span();
        places.file(span) == here && overlaps(places.range(span), params.range)
    };
    let diagnostics: Vec<&Diagnostic> = seen.diagnostics.iter().filter(in_range).collect();
    let mut actions = Vec::new();
    for diagnostic in diagnostics {
        for fix in &diagnostic.fixes {
            actions.push(quick_fix(world, &places, diagnostic, fix));
        }
    }
    let edits = rpi_diag::sure_edits(&seen.diagnostics);
    if !edits.is_empty() {
        actions.push(CodeAction {
            title: "apply all sure fixes".to_owned(),
            kind: Some(FIX_ALL),
            edit: Some(edit_of(world, &places, &edits)),
            ..CodeAction::default()
        });
    }
    let path = uri::to_path(&uri);
    let selection = Span::new(
        FileId(0),
        places.offset(params.range.start),
        places.offset(params.range.end),
    );
    let only = params.context.only.as_deref();
    // Each refactoring is checked, which takes as long as an analysis of the document.
    if only.is_none_or(|only| only.iter().any(is_refactoring)) {
        for one in refactor::refactorings(world, &path, &seen, selection) {
            actions.push(CodeAction {
                title: one.title,
                kind: Some(one.kind),
                edit: Some(edit_of(world, &places, &one.edits)),
                ..CodeAction::default()
            });
        }
    }
    let wanted = |action: &CodeAction| matches_filter(params.context.only.as_deref(), action);
    Some(actions.into_iter().filter(wanted).map(Into::into).collect())
}

fn quick_fix(
    world: &Workspace,
    places: &LocationMap<'_>,
    diagnostic: &Diagnostic,
    fix: &Fix,
) -> CodeAction {
    CodeAction {
        title: format!("{} ({})", fix.title, diagnostic.code),
        kind: Some(CodeActionKind::QUICKFIX),
        edit: Some(edit_of(world, places, &fix.edits)),
        is_preferred: Some(fix.applicability == Applicability::Sure),
        ..CodeAction::default()
    }
}

fn is_refactoring(kind: &CodeActionKind) -> bool {
    let kind = kind.as_str();
    kind.is_empty() || kind.split('.').next() == Some(CodeActionKind::REFACTOR.as_str())
}

/// Returns whether the client requested an action of this kind; `only` holds the requested kinds, and `None` stands for
/// all. Kinds are hierarchical: `source` includes `source.fixAll.rpi`.
fn matches_filter(only: Option<&[CodeActionKind]>, action: &CodeAction) -> bool {
    let kind = action.kind.as_ref().map_or("", |kind| kind.as_str());
    let covers = |wanted: &CodeActionKind| {
        let rest = kind.strip_prefix(wanted.as_str());
        rest.is_some_and(|rest| {
            rest.is_empty() || rest.starts_with('.') || wanted.as_str().is_empty()
        })
    };
    only.is_none_or(|only| only.iter().any(covers))
}

fn overlaps(a: Range, b: Range) -> bool {
    a.start <= b.end && b.start <= a.end
}

fn edit_of(world: &Workspace, places: &LocationMap<'_>, edits: &[Edit]) -> WorkspaceEdit {
    let mut files: BTreeMap<PathBuf, Vec<TextEdit>> = BTreeMap::new();
    for edit in edits {
        let of_file = files.entry(places.file(edit.span)).or_default();
        of_file.push(TextEdit::new(places.range(edit.span), edit.text.clone()));
    }
    crate::workspace_edit::workspace_edit(world, files)
}
