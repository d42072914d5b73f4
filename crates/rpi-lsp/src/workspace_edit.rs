//! Edits of several files in the form that the client supports.

use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;

use lsp_types::{
    DocumentChanges, OneOf, OptionalVersionedTextDocumentIdentifier, TextDocumentEdit, TextEdit,
    WorkspaceEdit,
};

use crate::workspace::Workspace;

/// Returns the edit of the protocol for edits of files, given by their paths.
pub(crate) fn workspace_edit(
    world: &Workspace,
    files: BTreeMap<PathBuf, Vec<TextEdit>>,
) -> WorkspaceEdit {
    match world.client.versioned_edits {
        true => versioned_edit(world, files),
        false => unversioned_edit(world, files),
    }
}

/// Returns an edit of several files that names the version of each open document. The client rejects the edit if a
/// document has another version.
fn versioned_edit(world: &Workspace, files: BTreeMap<PathBuf, Vec<TextEdit>>) -> WorkspaceEdit {
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
fn unversioned_edit(world: &Workspace, files: BTreeMap<PathBuf, Vec<TextEdit>>) -> WorkspaceEdit {
    let edit = |(path, edits): (PathBuf, Vec<TextEdit>)| Some((world.uri_of(&path)?, edits));
    let changes: HashMap<_, _> = files.into_iter().filter_map(edit).collect();
    WorkspaceEdit {
        changes: Some(changes),
        ..WorkspaceEdit::default()
    }
}
