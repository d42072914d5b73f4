//! Navigation: from a name to its declaration or to that of its type.

use std::rc::Rc;

use lsp_types::request::{GotoTypeDefinitionParams, GotoTypeDefinitionResponse};
use lsp_types::{GotoDefinitionParams, GotoDefinitionResponse, TextDocumentPositionParams};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;
use rpi_sema::query::{DefId, DefKind, Reference};

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

/// Handles `textDocument/typeDefinition`: returns the location of the declaration of the type of the name at a position.
/// The type of a flow with several parts, such as the result of a call, is the callee. Returns `None` if there is no
/// name, or its type is built in.
pub(crate) fn type_definition(
    world: &mut Workspace,
    params: GotoTypeDefinitionParams,
) -> Option<GotoTypeDefinitionResponse> {
    let (seen, name) = name_at(world, &params.text_document_position_params)?;
    let ty = type_of(&seen, name.def)?;
    let span = seen.index().def(ty).span;
    let location = world.locations(&seen).location(world, span)?;
    Some(GotoTypeDefinitionResponse::Scalar(location))
}

/// Returns the definition of the type of a definition: the type that its declaration names, otherwise the one with its
/// members.
fn type_of(seen: &Inspection, def: DefId) -> Option<DefId> {
    let index = seen.index();
    let def = index.def(def);
    let is_type = |name: &&Reference| {
        let kind = index.def(name.def).kind;
        matches!(kind, DefKind::Type | DefKind::Device)
    };
    let named = |ty: Span| index.references_in(ty).iter().find(is_type).map(|r| r.def);
    def.ty.and_then(named).or(def.shape)
}
