//! Completion.
//!
//! | file | content |
//! |---|---|
//! | `structure.rs`, `place.rs` | the place of the cursor, from the tokens before it, also in text with syntax errors |
//! | `items.rs`, `members.rs`, `words.rs`, `library.rs` | the names and keywords that can stand at the place |
//! | `expected.rs`, `candidate.rs` | expected type, order and limits of the answer |
//! | `documentation.rs` | documentation of an item, on a later request |

mod candidate;
mod documentation;
mod expected;
mod items;
mod library;
mod members;
mod place;
mod structure;
mod words;

use lsp_types::{CompletionParams, CompletionResponse};
use rpi_diag::{FileId, Span};

use crate::workspace::Workspace;
pub(crate) use documentation::resolve;
use place::{Cursor, Place};

/// Handles `textDocument/completion`: returns the suggestions for the cursor position, best first. Returns [`None`] in
/// comments, strings and numbers, where a new name is declared, or if the document is not open.
pub(crate) fn completion(
    world: &mut Workspace,
    params: CompletionParams,
) -> Option<CompletionResponse> {
    let at = params.text_document_position;
    let seen = world.analysis(&at.text_document.uri)?;
    world.completed = Some(at.text_document.uri);
    let places = world.locations(&seen);
    let offset = places.offset(at.position);
    let _focus = seen.focus(offset);
    let text = seen.sources.text(FileId(0));
    let cursor = Cursor::from_offset(text, offset as usize, seen.mode())?;
    let follows_bracket = text[offset as usize..].starts_with(['(', '<']);
    let collector = items::ItemCollector {
        analysis: &seen,
        places: &places,
        offset,
        cursor: &cursor,
        has_snippets: world.client.has_snippets && !follows_bracket,
        declaration: place::declaration(text, cursor.prefix.start, seen.mode()),
    };
    let start = u32::try_from(cursor.prefix.start).unwrap_or(u32::MAX);
    let range = places.range(Span::new(FileId(0), start, offset));
    let expected = expected::expected_type(&seen, offset, &cursor);
    // Without a typed word the primitives are left out.
    let has_more = matches!(cursor.place, Place::Value(_)) && collector.typed().is_empty();
    let list = candidate::list(
        collector.candidates(),
        collector.typed(),
        expected.as_deref(),
        range,
        has_more,
    );
    Some(CompletionResponse::List(list))
}
