//! Renaming of a declared name in all programs of the project.
//!
//! Occurrences come from the index of the checker, not from a text search. Before the edits are sent, every program
//! with an edit is checked again with the edits applied (`verify.rs`): a rename that changes to which declaration any
//! name refers, or that causes an error, is rejected with the reason.

mod linked;
mod verify;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use lsp_server::ErrorCode;
use lsp_types::{
    PrepareRenameResponse, RenameParams, TextDocumentPositionParams, TextEdit, WorkspaceEdit,
};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;
use rpi_sema::query::{DefId, DefKind, Reference};
use rpi_syntax::is_name;

use crate::dispatch::RequestError;
use crate::navigation::name_at;
use crate::programs::{Declaration, name_span};
use crate::workspace::Workspace;
use crate::workspace_edit::workspace_edit;
use crate::{builtin_documents, hover, uri};

/// Handles `textDocument/prepareRename`: returns the range of the name at a position and the name; `None` if there is no
/// word.
///
/// # Errors
/// Returns an error with the reason if the word at the position cannot be renamed.
pub(crate) fn prepare(
    world: &mut Workspace,
    at: TextDocumentPositionParams,
) -> Result<Option<PrepareRenameResponse>, RequestError> {
    let Some((seen, name)) = name_at(world, &at) else {
        return unnamed(world, &at).map(|()| None);
    };
    check_renamable(&seen, name.def)?;
    let placeholder = seen.index().def(name.def).name.to_string();
    let span = name_span(&seen, name.span, &placeholder).unwrap_or(name.span);
    let range = world.locations(&seen).range(span);
    Ok(Some(PrepareRenameResponse::RangeWithPlaceholder {
        range,
        placeholder,
    }))
}

/// Handles `textDocument/rename`: returns the edits of all files of the project; `None` if there is no word at the
/// position.
///
/// # Errors
/// Returns an error with the reason if the name cannot be renamed, the new name is not a name, or it conflicts with
/// another declaration.
pub(crate) fn rename(
    world: &mut Workspace,
    params: RenameParams,
) -> Result<Option<WorkspaceEdit>, RequestError> {
    let at = params.text_document_position;
    let Some((seen, name)) = name_at(world, &at) else {
        return unnamed(world, &at).map(|()| None);
    };
    check_renamable(&seen, name.def)?;
    let new = params.new_name.trim();
    if !is_name(new, seen.mode()) {
        return Err(rejection(format!("`{new}` is not a name of the language")));
    }
    let path = uri::to_path(&at.text_document.uri);
    let plan = plan(world, &path, &seen, name)?;
    if world.is_cancelled() {
        return Ok(None);
    }
    verify::verify(world, &plan, new)?;
    let mut edits: BTreeMap<PathBuf, Vec<TextEdit>> = BTreeMap::new();
    for (path, spans) in &plan.edits {
        let ranges = spans.iter().map(|span| world.range_in(path, span.clone()));
        let of_file = ranges.map(|range| TextEdit::new(range, new.to_owned()));
        edits.insert(path.clone(), of_file.collect());
    }
    Ok(Some(workspace_edit(world, edits)))
}

/// Byte range in a file. Ranges of one file do not overlap.
type ByteRange = std::ops::Range<u32>;

/// Edits of a rename before they are verified.
pub(crate) struct RenamePlan {
    /// Ranges that the new name replaces, by file, in text order and without duplicates.
    edits: BTreeMap<PathBuf, Vec<ByteRange>>,
    /// Programs with an edited file, by the path of the root file, with their analyses before the rename.
    programs: BTreeMap<PathBuf, Rc<Inspection>>,
}

fn rejection(reason: String) -> RequestError {
    RequestError::new(ErrorCode::RequestFailed, reason)
}

/// Returns an error with the reason if there is a word without a declaration at the position, such as a keyword.
fn unnamed(world: &mut Workspace, at: &TextDocumentPositionParams) -> Result<(), RequestError> {
    let Some(seen) = world.analysis(&at.text_document.uri) else {
        return Ok(());
    };
    let offset = world.locations(&seen).offset(at.position);
    match hover::describe_builtin_at(&seen, offset) {
        Some((span, description)) => Err(rejection(format!(
            "`{}` is part of the language ({}) and cannot be renamed",
            seen.sources.slice(span),
            description.kind
        ))),
        None => Ok(()),
    }
}

/// Returns an error with the reason if the user cannot change the declaration.
fn check_renamable(seen: &Inspection, def: DefId) -> Result<(), RequestError> {
    let def = seen.index().def(def);
    let file = seen.sources.name(def.span.file);
    let name = &def.name;
    if builtin_documents::is_builtin(Path::new(file)) {
        return Err(rejection(format!(
            "`{name}` is declared in the standard library ({file}), which cannot be changed"
        )));
    }
    if !file.ends_with(".rpi") && !file.ends_with(".lus") && def.span.file != FileId(0) {
        return Err(rejection(format!(
            "`{name}` is made from an entry of {file}; rename the entry in this file"
        )));
    }
    match def.kind {
        DefKind::Module => Err(rejection(format!(
            "a module has the name of its file; rename the file of `{name}` and its `use` clauses"
        ))),
        DefKind::Test => Err(rejection(
            "the title of a test is a text without references; edit it".to_owned(),
        )),
        DefKind::Primitive => Err(rejection(format!(
            "`{name}` is a primitive of the control core, which cannot be renamed"
        ))),
        _ => Ok(()),
    }
}

/// Collects the ranges of all occurrences of a declaration, and of those that are linked with it by their name.
fn plan(
    world: &mut Workspace,
    near: &Path,
    seen: &Rc<Inspection>,
    name: Reference,
) -> Result<RenamePlan, RequestError> {
    let start = Declaration::new(seen, seen.index().def(name.def));
    let mut spans: BTreeMap<PathBuf, BTreeSet<(u32, u32)>> = BTreeMap::new();
    let mut programs = BTreeMap::new();
    let mut known = BTreeSet::from([start.clone()]);
    let mut open = vec![start];
    let mut rejected = None;
    while let Some(declaration) = open.pop() {
        world.for_programs_with(near, &declaration, &mut |world, path, seen, def| {
            let places = world.locations(seen);
            for span in renamed_spans(seen, def) {
                let of_file = spans.entry(places.file(span)).or_default();
                of_file.insert((span.start, span.end));
            }
            for linked in linked::linked_defs(seen, def) {
                let found = Declaration::new(seen, seen.index().def(linked));
                rejected = rejected.take().or(check_renamable(seen, linked).err());
                if known.insert(found.clone()) {
                    open.push(found);
                }
            }
            programs.insert(path.to_owned(), Rc::clone(seen));
        });
    }
    if let Some(error) = rejected {
        return Err(error);
    }
    if let Some(library) = spans
        .keys()
        .find(|path| builtin_documents::is_builtin(path))
    {
        let file = library.display();
        return Err(rejection(format!(
            "the name is used in {file}, which cannot be changed"
        )));
    }
    let ranges = |spans: BTreeSet<(u32, u32)>| spans.into_iter().map(|(a, b)| a..b).collect();
    Ok(RenamePlan {
        edits: spans
            .into_iter()
            .map(|(path, all)| (path, ranges(all)))
            .collect(),
        programs,
    })
}

/// Returns the ranges of the name in all occurrences of a definition in a program, including links in doc comments.
fn renamed_spans(seen: &Inspection, def: DefId) -> Vec<Span> {
    let name = seen.index().def(def).name.clone();
    let references = seen.index().references(def);
    let names = references.filter_map(|span| name_span(seen, span, &name));
    names.chain(linked::doc_links(seen, def)).collect()
}
