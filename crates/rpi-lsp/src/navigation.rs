//! Navigation: definitions, references, highlights.

use std::rc::Rc;

use lsp_types::{
    DocumentHighlight, DocumentHighlightParams, GotoDefinitionParams, GotoDefinitionResponse,
    Location, ReferenceParams, TextDocumentPositionParams,
};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;
use rpi_sema::query::{DefId, Reference};

use crate::workspace::Workspace;

/// Returns the analysis of the document, and the name at a position with its definition. Returns `None` if the document
/// is not open or there is no name at the position.
pub(crate) fn name_at(
    world: &mut Workspace,
    at: &TextDocumentPositionParams,
) -> Option<(Rc<Inspection>, Reference)> {
    let seen = world.analysis(&at.text_document.uri)?;
    let offset = world.locations(&seen).offset(at.position);
    let found = seen.index().reference_at(FileId(0), offset)?;
    Some((seen, found))
}

/// Handles `textDocument/definition`: returns the location of the declaration of the name at a position; `None` if
/// there is no name.
pub(crate) fn definition(
    world: &mut Workspace,
    params: GotoDefinitionParams,
) -> Option<GotoDefinitionResponse> {
    let (seen, name) = name_at(world, &params.text_document_position_params)?;
    let span = seen.index().def(name.def).span;
    let location = world.locations(&seen).location(world, span)?;
    Some(GotoDefinitionResponse::Scalar(location))
}

/// Handles `textDocument/references`: returns the locations of all uses of the name at a position, in the programs of
/// all open documents; `None` if there is no name.
pub(crate) fn references(world: &mut Workspace, params: ReferenceParams) -> Option<Vec<Location>> {
    let (seen, name) = name_at(world, &params.text_document_position)?;
    let own = seen.index().def(name.def).span;
    let file = seen.sources.name(own.file);
    let mut found: Vec<Location> = Vec::new();
    for uri in world.open_documents() {
        let Some(other) = world.analysis(&uri) else {
            continue;
        };
        // Definition ids differ between analyses, so the definition is looked up again by its place.
        let mut files = other.sources.files();
        let same = files.find(|id| other.sources.name(*id) == file);
        let Some(name) = same.and_then(|id| other.index().reference_at(id, own.start)) else {
            continue;
        };
        let places = world.locations(&other);
        let spans = reference_spans(&other, name.def, params.context.include_declaration);
        for location in spans.filter_map(|span| places.location(world, span)) {
            if !found.contains(&location) {
                found.push(location);
            }
        }
    }
    Some(found)
}

/// Handles `textDocument/documentHighlight`: returns all uses of the name at a position within the document; `None` if
/// there is no name.
pub(crate) fn highlights(
    world: &mut Workspace,
    params: DocumentHighlightParams,
) -> Option<Vec<DocumentHighlight>> {
    let (seen, name) = name_at(world, &params.text_document_position_params)?;
    let places = world.locations(&seen);
    let here = reference_spans(&seen, name.def, true).filter(|span| span.file == FileId(0));
    let highlights = here.map(|span| DocumentHighlight {
        range: places.range(span),
        kind: None,
    });
    Some(highlights.collect())
}

fn reference_spans(
    seen: &Inspection,
    def: DefId,
    declared: bool,
) -> impl Iterator<Item = Span> + '_ {
    let index = seen.index();
    let own = index.def(def).span;
    index
        .references(def)
        .filter(move |span| declared || *span != own)
}
