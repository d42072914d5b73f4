//! Outline of a document: its declarations, and the definitions nested in them.

use std::collections::BTreeMap;

use lsp_types::{DocumentSymbol, DocumentSymbolParams, DocumentSymbolResponse, SymbolKind};
use rpi_diag::FileId;
use rpi_sema::query::{Def, DefId, DefKind};

use crate::locations::LocationMap;
use crate::workspace::Workspace;

/// Kinds of definitions in the outline of a document, each with its symbol kind in the protocol. Definitions of other
/// kinds are not part of the outline.
const SYMBOL_KINDS: &[(DefKind, SymbolKind)] = &[
    (DefKind::Const, SymbolKind::CONSTANT),
    (DefKind::Type, SymbolKind::STRUCT),
    (DefKind::EnumValue, SymbolKind::ENUM_MEMBER),
    (DefKind::Field, SymbolKind::FIELD),
    (DefKind::Node, SymbolKind::FUNCTION),
    (DefKind::Function, SymbolKind::FUNCTION),
    (DefKind::Fragment, SymbolKind::MODULE),
    (DefKind::Primitive, SymbolKind::OPERATOR),
    (DefKind::Device, SymbolKind::INTERFACE),
    (DefKind::Port, SymbolKind::PROPERTY),
    (DefKind::Frame, SymbolKind::OBJECT),
    (DefKind::Command, SymbolKind::CLASS),
    (DefKind::Result, SymbolKind::EVENT),
    (DefKind::Task, SymbolKind::CLASS),
    (DefKind::Step, SymbolKind::EVENT),
    (DefKind::Test, SymbolKind::METHOD),
    (DefKind::Local, SymbolKind::VARIABLE),
    (DefKind::Block, SymbolKind::MODULE),
    (DefKind::State, SymbolKind::MODULE),
];

/// Returns the symbol kind in the protocol of a kind of definition; `None` if such definitions are not shown.
pub(crate) fn symbol_kind(kind: DefKind) -> Option<SymbolKind> {
    let row = SYMBOL_KINDS.iter().find(|(known, _)| *known == kind);
    row.map(|(_, kind)| *kind)
}

/// Handles `textDocument/documentSymbol`: returns the outline of a document, as a tree of its declarations; `None` if
/// the document is not open.
pub(crate) fn symbols(
    world: &mut Workspace,
    params: DocumentSymbolParams,
) -> Option<DocumentSymbolResponse> {
    let seen = world.analysis(&params.text_document.uri)?;
    let places = world.locations(&seen);
    let index = seen.index();
    let mut all: Vec<(DefId, &Def)> = index.defs_in(FileId(0)).collect();
    all.sort_by_key(|(_, def)| (def.full_span.start, def.span.start));
    let is_inside = |def: DefId| index.def(def).kind != DefKind::Module;
    let mut outline = Outline {
        places,
        children: BTreeMap::new(),
    };
    for (id, def) in all {
        let parent = def.parent.filter(|parent| is_inside(*parent));
        outline.children.entry(parent).or_default().push((id, def));
    }
    Some(DocumentSymbolResponse::Nested(outline.symbols_in(None)))
}

struct Outline<'s> {
    places: LocationMap<'s>,
    /// For each definition, the definitions nested directly in it; for `None`, the declarations at the top level.
    children: BTreeMap<Option<DefId>, Vec<(DefId, &'s Def)>>,
}

impl Outline<'_> {
    fn symbols_in(&self, parent: Option<DefId>) -> Vec<DocumentSymbol> {
        let defs = self.children.get(&parent).into_iter().flatten();
        defs.filter_map(|(id, def)| self.symbol(*id, def)).collect()
    }

    // The struct has a deprecated field, which must be set nevertheless.
    #[allow(deprecated)]
    fn symbol(&self, id: DefId, def: &Def) -> Option<DocumentSymbol> {
        let kind = symbol_kind(def.kind)?;
        let children = self.symbols_in(Some(id));
        Some(DocumentSymbol {
            name: def.name.to_string(),
            detail: Some(def.kind.description().to_owned()),
            kind,
            tags: None,
            deprecated: None,
            range: self.places.range(def.full_span.merge(def.span)),
            selection_range: self.places.range(def.span),
            children: (!children.is_empty()).then_some(children),
        })
    }
}
