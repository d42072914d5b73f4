//! What could be written at a position.
//!
//! `cursor.rs` tells from the pieces of the text what can stand there, however broken it is; `names.rs` finds the names
//! for it, `library.rs` those of modules that are not used yet.

mod cursor;
mod library;
mod names;

use lsp_types::{CompletionList, CompletionParams, CompletionResponse};

use crate::world::World;
use cursor::Cursor;

/// What could be written at a position; nothing in comments and texts.
pub(crate) fn completion(
    world: &mut World,
    params: CompletionParams,
) -> Option<CompletionResponse> {
    let at = params.text_document_position;
    let seen = world.see(&at.text_document.uri)?;
    let places = world.places(&seen);
    let offset = places.offset(at.position);
    let text = seen.sources.text(rpi_diag::FileId(0));
    let cursor = Cursor::at(text, offset as usize, seen.mode())?;
    let list = names::Names::new(&seen, &places, offset, &cursor).list();
    Some(CompletionResponse::List(CompletionList {
        // The primitives are told by what is written of them.
        is_incomplete: true,
        items: list,
    }))
}
