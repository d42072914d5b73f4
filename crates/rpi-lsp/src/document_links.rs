//! Document links: from `use` and `include` to the files.

use lsp_types::{DocumentLink, DocumentLinkParams};
use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;
use rpi_syntax::ast::{Ident, ItemKind};

use crate::workspace::Workspace;
use crate::{builtin_documents, uri};

/// Handles `textDocument/documentLink`: returns a link for each module after `use` and each file after `include`; `None`
/// if the document is not open.
pub(crate) fn document_links(
    world: &mut Workspace,
    params: DocumentLinkParams,
) -> Option<Vec<DocumentLink>> {
    let seen = world.analysis(&params.text_document.uri)?;
    let places = world.locations(&seen);
    let path = uri::to_path(&params.text_document.uri);
    let folder = path.parent();
    let mut links = Vec::new();
    let mut add = |span: Span, target: Option<lsp_types::Uri>| {
        let Some(target) = target else { return };
        links.push(DocumentLink {
            range: places.range(span),
            target: Some(target),
            tooltip: None,
            data: None,
        });
    };
    for item in seen.own_items().filter(|item| item.span.file == FileId(0)) {
        match &item.kind {
            ItemKind::Use(names) => {
                for name in names {
                    let file = module_file(&seen, name);
                    let target = file.map(builtin_documents::source_path);
                    add(name.span, target.and_then(|path| world.uri_of(&path)));
                }
            }
            ItemKind::Include(file) => {
                let target = folder.map(|folder| folder.join(file.name.as_str()));
                let target = target.filter(|path| world.text(path).is_some());
                add(file.span, target.and_then(|path| world.uri_of(&path)));
            }
            _ => {}
        }
    }
    Some(links)
}

/// Returns the name of the source file of a module that the document uses; `None` if there is no such module, or it is
/// empty.
fn module_file<'s>(seen: &'s Inspection, name: &Ident) -> Option<&'s str> {
    let found = seen.index().reference_at(FileId(0), name.span.start)?;
    let span = seen.index().def(found.def).span;
    (!span.is_none()).then(|| seen.sources.name(span.file))
}
