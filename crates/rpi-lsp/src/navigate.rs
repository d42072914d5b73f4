//! Where things are: definitions, references.

use std::rc::Rc;

use lsp_types::{
    DocumentHighlight, DocumentHighlightParams, GotoDefinitionParams, GotoDefinitionResponse,
    Location, ReferenceParams, TextDocumentPositionParams,
};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspected;
use rpi_sema::query::{DefId, Reference};

use crate::world::World;

/// The name at a position, and what it means.
pub(crate) fn name_at(
    world: &mut World,
    at: &TextDocumentPositionParams,
) -> Option<(Rc<Inspected>, Reference)> {
    let seen = world.see(&at.text_document.uri)?;
    let offset = world.places(&seen).offset(at.position);
    let found = seen.index().at(FileId(0), offset)?;
    Some((seen, found))
}

/// Where a name is declared.
pub(crate) fn definition(
    world: &mut World,
    params: GotoDefinitionParams,
) -> Option<GotoDefinitionResponse> {
    let (seen, name) = name_at(world, &params.text_document_position_params)?;
    let span = seen.index().def(name.def).span;
    let location = world.places(&seen).location(world, span)?;
    Some(GotoDefinitionResponse::Scalar(location))
}

/// Every place where a name is used.
pub(crate) fn references(world: &mut World, params: ReferenceParams) -> Option<Vec<Location>> {
    let (seen, name) = name_at(world, &params.text_document_position)?;
    let places = world.places(&seen);
    let spans = spans(&seen, name.def, params.context.include_declaration);
    let locations = spans.filter_map(|span| places.location(world, span));
    Some(locations.collect())
}

/// The same in one text.
pub(crate) fn highlights(
    world: &mut World,
    params: DocumentHighlightParams,
) -> Option<Vec<DocumentHighlight>> {
    let (seen, name) = name_at(world, &params.text_document_position_params)?;
    let places = world.places(&seen);
    let here = spans(&seen, name.def, true).filter(|span| span.file == FileId(0));
    let highlights = here.map(|span| DocumentHighlight {
        range: places.range(span),
        kind: None,
    });
    Some(highlights.collect())
}

fn spans(seen: &Inspected, def: DefId, declared: bool) -> impl Iterator<Item = Span> + '_ {
    let index = seen.index();
    let own = index.def(def).span;
    index
        .references(def)
        .filter(move |span| declared || *span != own)
}
