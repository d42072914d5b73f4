//! References: all uses of a name in the programs of the project.

use lsp_types::{Location, ReferenceParams};

use crate::navigation::name_at;
use crate::programs::Declaration;
use crate::uri;
use crate::workspace::Workspace;

/// Handles `textDocument/references`: returns the locations of all uses of the name at a position, in all programs of
/// the project, sorted by file and place; `None` if there is no name.
pub(crate) fn references(world: &mut Workspace, params: ReferenceParams) -> Option<Vec<Location>> {
    let (seen, name) = name_at(world, &params.text_document_position)?;
    let near = uri::to_path(&params.text_document_position.text_document.uri);
    let declaration = Declaration::new(&seen, seen.index().def(name.def));
    let declared = params.context.include_declaration;
    Some(locations(world, &near, &declaration, declared))
}

/// Returns the locations of all uses of a declaration in the project that contains the file `near`, with the declaration
/// itself if `declared` is true.
pub(crate) fn locations(
    world: &mut Workspace,
    near: &std::path::Path,
    declaration: &Declaration,
    declared: bool,
) -> Vec<Location> {
    let mut found: Vec<Location> = Vec::new();
    world.for_programs_with(near, declaration, &mut |world, _, seen, def| {
        let own = seen.index().def(def).span;
        let places = world.locations(seen);
        let spans = seen.index().references(def);
        let spans = spans.filter(|span| declared || *span != own);
        found.extend(spans.filter_map(|span| places.location(world, span)));
    });
    let key = |one: &Location| (one.uri.as_str().to_owned(), one.range.start, one.range.end);
    found.sort_by_key(key);
    found.dedup();
    found
}
