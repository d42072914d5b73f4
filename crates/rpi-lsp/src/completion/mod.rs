//! Completion.
//!
//! `cursor.rs` determines from the tokens before the cursor which kind of name is expected, also in text with syntax
//! errors. `items.rs` collects the matching names, `library.rs` those of modules that are not imported yet.

mod cursor;
mod items;
mod library;

use lsp_types::{CompletionList, CompletionParams, CompletionResponse};

use crate::workspace::Workspace;
use cursor::Cursor;

/// Handles `textDocument/completion`: returns the suggestions for the cursor position. Returns [`None`] inside
/// comments, strings and numbers, or if the document is not open.
pub(crate) fn completion(
    world: &mut Workspace,
    params: CompletionParams,
) -> Option<CompletionResponse> {
    let at = params.text_document_position;
    let seen = world.analysis(&at.text_document.uri)?;
    let places = world.locations(&seen);
    let offset = places.offset(at.position);
    let text = seen.sources.text(rpi_diag::FileId(0));
    let cursor = Cursor::from_offset(text, offset as usize, seen.mode())?;
    let list = items::ItemCollector::new(&seen, &places, offset, &cursor).items();
    Some(CompletionResponse::List(CompletionList {
        // The list depends on the text typed so far: primitives are filtered by it.
        is_incomplete: true,
        items: list,
    }))
}
