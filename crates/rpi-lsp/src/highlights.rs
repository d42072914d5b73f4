//! Highlights: the uses of a name in a document, distinguished into reads and definitions.

use std::collections::BTreeSet;

use lsp_types::{DocumentHighlight, DocumentHighlightKind, DocumentHighlightParams};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;
use rpi_syntax::ast::{Statement, StatementKind, Visitor, Walker};

use crate::navigation::name_at;
use crate::workspace::Workspace;

/// Handles `textDocument/documentHighlight`: returns all uses of the name at a position within the document; `None` if
/// there is no name. The declaration and the left sides of equations are writes.
pub(crate) fn highlights(
    world: &mut Workspace,
    params: DocumentHighlightParams,
) -> Option<Vec<DocumentHighlight>> {
    let (seen, name) = name_at(world, &params.text_document_position_params)?;
    let places = world.locations(&seen);
    let written = written_names(&seen);
    let own = seen.index().def(name.def).span;
    let all = seen.index().references(name.def);
    let here = all.filter(|span| span.file == FileId(0));
    let kind = |span: &Span| match *span == own || written.contains(span) {
        true => DocumentHighlightKind::WRITE,
        false => DocumentHighlightKind::READ,
    };
    let highlights = here.map(|span| DocumentHighlight {
        range: places.range(span),
        kind: Some(kind(&span)),
    });
    Some(highlights.collect())
}

/// Returns the places of names that equations of the main module define.
pub(crate) fn written_names(seen: &Inspection) -> BTreeSet<Span> {
    let mut names = WrittenNames(BTreeSet::new());
    for item in seen.own_items() {
        Walker::new(&mut names).item(item);
    }
    names.0
}

struct WrittenNames(BTreeSet<Span>);

impl<'a> Visitor<'a> for WrittenNames {
    fn visits_expressions(&self) -> bool {
        false
    }

    fn visit_statement(&mut self, statement: &'a Statement) {
        if let StatementKind::Equation(equation) = &statement.kind {
            let targets = equation.targets.iter();
            let last = targets.map(|target| {
                let fields = target.path.iter().rev();
                let mut fields = fields.filter_map(|access| match access {
                    rpi_syntax::ast::Access::Field(field) => Some(field.span),
                    _ => None,
                });
                fields.next().unwrap_or(target.name.span)
            });
            self.0.extend(last);
        }
    }
}
