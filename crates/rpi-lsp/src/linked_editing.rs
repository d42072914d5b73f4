//! Linked editing: the uses of a name that the editor changes together while the user types.

use lsp_types::{LinkedEditingRangeParams, LinkedEditingRanges};
use rpi_diag::FileId;
use rpi_sema::query::DefKind;

use crate::navigation::name_at;
use crate::programs::name_span;
use crate::workspace::Workspace;

/// Kinds of definitions whose uses are all in their own declaration, so that other files are not affected.
const LOCAL_KINDS: &[DefKind] = &[
    DefKind::Local,
    DefKind::Block,
    DefKind::State,
    DefKind::Step,
];

/// Pattern of a name of the language, as a regular expression.
const NAME: &str = "[A-Za-z_][A-Za-z0-9_']*";

/// Handles `textDocument/linkedEditingRange`: returns all uses of the name at a position, if it is a flow, fragment or
/// state inside of a body or a step of a task. Returns `None` for any other name.
pub(crate) fn linked_editing(
    world: &mut Workspace,
    params: LinkedEditingRangeParams,
) -> Option<LinkedEditingRanges> {
    let (seen, name) = name_at(world, &params.text_document_position_params)?;
    let index = seen.index();
    let def = index.def(name.def);
    if !LOCAL_KINDS.contains(&def.kind) || def.span.file != FileId(0) {
        return None;
    }
    let places = world.locations(&seen);
    let spans = index.references(name.def);
    let spans = spans.filter(|span| span.file == FileId(0));
    let ranges = spans.filter_map(|span| name_span(&seen, span, &def.name));
    Some(LinkedEditingRanges {
        ranges: ranges.map(|span| places.range(span)).collect(),
        word_pattern: Some(NAME.to_owned()),
    })
}
