//! Inlay hints: the inferred types of flows, with unit and `?`.

use lsp_types::{InlayHint, InlayHintKind, InlayHintLabel, InlayHintParams};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;
use rpi_sema::query::{Def, DefKind, FlowType};

use crate::workspace::Workspace;

/// Maximum number of types in a hint. A flow of a generic node has a type for each choice of static arguments.
const MAX_TYPES: usize = 2;

/// Maximum length of a hint in characters. A longer type is cut, and hovering shows it in full.
const MAX_LENGTH: usize = 40;

/// Handles `textDocument/inlayHint`: returns the inferred type of each flow in the range whose declaration has none;
/// `None` if the document is not open.
pub(crate) fn inlay_hints(
    world: &mut Workspace,
    params: InlayHintParams,
) -> Option<Vec<InlayHint>> {
    let seen = world.analysis(&params.text_document.uri)?;
    if !world.settings.inlay_hints {
        return Some(Vec::new());
    }
    let places = world.locations(&seen);
    let start = places.offset(params.range.start);
    let end = places.offset(params.range.end);
    let in_range = |span: Span| start <= span.end && span.start <= end;
    let defs = seen.index().defs_in(FileId(0)).map(|(_, def)| def);
    let hints = defs.filter(|def| in_range(def.span)).filter_map(|def| {
        let (label, tooltip) = type_hint(&seen, def)?;
        Some(InlayHint {
            position: places.range(def.span).end,
            label: InlayHintLabel::String(label),
            kind: Some(InlayHintKind::TYPE),
            text_edits: None,
            tooltip: tooltip.map(lsp_types::InlayHintTooltip::String),
            padding_left: None,
            padding_right: Some(false),
            data: None,
        })
    });
    let mut hints: Vec<InlayHint> = hints.collect();
    hints.sort_by_key(|hint| hint.position);
    Some(hints)
}

/// Returns the hint with the inferred type of a definition, and the full text if the hint is cut; `None` if its
/// declaration has a type, or the checker did not infer one.
fn type_hint(seen: &Inspection, def: &Def) -> Option<(String, Option<String>)> {
    let is_inferred = matches!(def.kind, DefKind::Local | DefKind::Const) && def.ty.is_none();
    let types = match is_inferred {
        true => seen.types_of(def),
        false => return None,
    };
    if types.is_empty() {
        return None;
    }
    let shown: Vec<String> = types
        .iter()
        .take(MAX_TYPES)
        .map(FlowType::to_string)
        .collect();
    let more = if types.len() > MAX_TYPES {
        " or \u{2026}"
    } else {
        ""
    };
    let full = format!(": {}{more}", shown.join(" or "));
    match full.char_indices().nth(MAX_LENGTH) {
        Some((at, _)) => Some((format!("{}\u{2026}", &full[..at]), Some(full))),
        None => Some((full, None)),
    }
}
