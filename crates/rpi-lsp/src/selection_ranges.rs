//! Selection ranges: the constructs around a position, from the token to the whole document.

use lsp_types::{Position, SelectionRange, SelectionRangeParams};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;
use rpi_syntax::source_tokens;

use crate::locations::LocationMap;
use crate::syntax_ranges::SyntaxRanges;
use crate::workspace::Workspace;

/// Handles `textDocument/selectionRange`: returns for each position the constructs that contain it, innermost first;
/// `None` if the document is not open.
pub(crate) fn selection_ranges(
    world: &mut Workspace,
    params: SelectionRangeParams,
) -> Option<Vec<SelectionRange>> {
    let seen = world.analysis(&params.text_document.uri)?;
    let places = world.locations(&seen);
    let spans = all_spans(&seen);
    let at = |position: Position| chain(&places, &spans, position);
    Some(params.positions.into_iter().map(at).collect())
}

/// Returns the ranges of all tokens and constructs of a document, and of the whole document.
fn all_spans(seen: &Inspection) -> Vec<Span> {
    let text = seen.sources.text(FileId(0));
    let offset = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
    let span = |start: usize, end: usize| Span::new(FileId(0), offset(start), offset(end));
    let ranges = SyntaxRanges::new(seen);
    let tokens = source_tokens(text, seen.mode());
    let tokens = tokens
        .into_iter()
        .map(|piece| span(piece.range.start, piece.range.end));
    let constructs = ranges.blocks.into_iter().chain(ranges.expressions);
    tokens
        .chain(constructs)
        .chain([span(0, text.len())])
        .collect()
}

/// Returns the ranges around a position as a chain. Each contains the one before; ranges that overlap partly are left
/// out.
fn chain(places: &LocationMap<'_>, spans: &[Span], position: Position) -> SelectionRange {
    let offset = places.offset(position);
    let holds = |span: &&Span| span.start <= offset && offset <= span.end;
    let mut around: Vec<Span> = spans.iter().filter(holds).copied().collect();
    around.sort_by_key(|span| (span.end - span.start, span.start));
    around.dedup();
    let mut nested: Vec<Span> = Vec::new();
    for span in around {
        if nested
            .last()
            .is_none_or(|last| span.contains(*last) && span != *last)
        {
            nested.push(span);
        }
    }
    let outer = nested.into_iter().rev().fold(None, |parent, span| {
        Some(Box::new(SelectionRange {
            range: places.range(span),
            parent,
        }))
    });
    outer.map_or_else(
        || SelectionRange {
            range: lsp_types::Range::new(position, position),
            parent: None,
        },
        |outer| *outer,
    )
}
