//! Folding: blocks, imports and comments of several lines.

use std::collections::BTreeSet;

use lsp_types::{FoldingRange, FoldingRangeKind, FoldingRangeParams};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;
use rpi_syntax::ast::ItemKind;
use rpi_syntax::{SourceToken, SourceTokenKind, source_tokens};

use crate::locations::LocationMap;
use crate::syntax_ranges::SyntaxRanges;
use crate::workspace::Workspace;

/// Handles `textDocument/foldingRange`: returns the ranges that the editor can fold; `None` if the document is not open.
/// Of several ranges that start in one line, the longest one is returned.
pub(crate) fn folding(
    world: &mut Workspace,
    params: FoldingRangeParams,
) -> Option<Vec<FoldingRange>> {
    let seen = world.analysis(&params.text_document.uri)?;
    let places = world.locations(&seen);
    let blocks = SyntaxRanges::new(&seen).blocks;
    let mut folds: Vec<FoldingRange> = blocks
        .iter()
        .filter_map(|span| fold(&places, *span, None))
        .collect();
    let imports = imports(&seen);
    folds.extend(imports.and_then(|span| fold(&places, span, Some(FoldingRangeKind::Imports))));
    let comment = |span: &Span| fold(&places, *span, Some(FoldingRangeKind::Comment));
    folds.extend(comments(&seen).iter().filter_map(comment));
    folds.sort_by_key(|one| (one.start_line, std::cmp::Reverse(one.end_line)));
    let mut lines = BTreeSet::new();
    folds.retain(|one| lines.insert(one.start_line));
    Some(folds)
}

/// Returns the fold of a range; `None` if it lies in one line.
fn fold(
    places: &LocationMap<'_>,
    span: Span,
    kind: Option<FoldingRangeKind>,
) -> Option<FoldingRange> {
    let range = places.range(span);
    (range.start.line < range.end.line).then(|| FoldingRange {
        start_line: range.start.line,
        end_line: range.end.line,
        kind,
        ..FoldingRange::default()
    })
}

/// Returns the range from the first to the last `use` or `include` at the start of a document.
fn imports(seen: &Inspection) -> Option<Span> {
    let items = seen.own_items().filter(|item| item.span.file == FileId(0));
    let head =
        items.take_while(|item| matches!(item.kind, ItemKind::Use(_) | ItemKind::Include(_)));
    head.map(|item| item.span).reduce(Span::merge)
}

/// Returns the ranges of the comments of a document. Comments in consecutive lines are one range.
fn comments(seen: &Inspection) -> Vec<Span> {
    let text = seen.sources.text(FileId(0));
    let is_comment = |piece: &SourceToken| matches!(piece.kind, SourceTokenKind::Comment(_));
    let mut found: Vec<Span> = Vec::new();
    for piece in source_tokens(text, seen.mode())
        .into_iter()
        .filter(is_comment)
    {
        let offset = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
        let span = Span::new(
            FileId(0),
            offset(piece.range.start),
            offset(piece.range.end),
        );
        match found.last_mut() {
            Some(last) if follows(text, *last, span) => *last = last.merge(span),
            _ => found.push(span),
        }
    }
    found
}

/// Returns whether a comment starts in the line after the end of another one, with nothing else in between.
fn follows(text: &str, last: Span, next: Span) -> bool {
    let gap = text.get(last.end as usize..next.start as usize);
    gap.is_some_and(|gap| gap.trim().is_empty() && gap.matches('\n').count() <= 1)
}
