//! Names of the standard library, for completion with an additional `use`.

use std::sync::LazyLock;

use rpi_diag::FileId;
use rpi_syntax::ast::{Doc, Item, ItemKind};
use rpi_syntax::{Dialect, Name, parse};

/// Name that a module of the standard library declares, with the text that completion shows for it.
#[derive(Clone, Debug)]
pub(super) struct LibraryName {
    pub(super) module: &'static str,
    pub(super) kind: LibraryKind,
    pub(super) name: Name,
    /// Text of the declaration without its body.
    pub(super) head: String,
    pub(super) doc: Option<Doc>,
}

/// Kind of a name of the library, which decides where it can stand.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum LibraryKind {
    /// Callable or constant.
    Value,
    /// Type or device type.
    Type,
}

/// Returns the names that all modules of the standard library declare, by module and in source order.
pub(super) fn library_names() -> &'static [LibraryName] {
    static OFFERS: LazyLock<Vec<LibraryName>> = LazyLock::new(|| {
        let modules = rpi_driver::library_modules();
        modules.flat_map(module_names).collect()
    });
    &OFFERS
}

fn module_names(module: &'static str) -> Vec<LibraryName> {
    let text = rpi_driver::library_text(module).unwrap_or_default();
    let parsed = parse(FileId(0), text, Dialect::Rpi);
    let offer = |item: &Item| {
        Some(LibraryName {
            module,
            kind: match item.kind {
                ItemKind::Device(_) | ItemKind::Type(_) => LibraryKind::Type,
                _ => LibraryKind::Value,
            },
            name: declared_name(item)?,
            head: rpi_syntax::header(item, Dialect::Rpi),
            doc: item.doc.clone(),
        })
    };
    parsed.file.items.iter().filter_map(offer).collect()
}

/// Returns the name that a top-level declaration introduces; [`None`] for a kind of declaration that completion does
/// not suggest, such as a primitive.
fn declared_name(item: &Item) -> Option<Name> {
    match &item.kind {
        ItemKind::Node(node) => Some(node.signature.name.name.clone()),
        ItemKind::Fragment(fragment) => Some(fragment.signature.name.name.clone()),
        ItemKind::Device(device) => Some(device.name.name.clone()),
        ItemKind::Const(defs) => defs.first()?.names.first().map(|name| name.name.clone()),
        ItemKind::Type(defs) => defs.first().map(|def| def.name.name.clone()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_offers_its_names() {
        let line = library_names()
            .iter()
            .find(|offer| offer.name == "Line")
            .unwrap();
        assert_eq!(line.module, "motion");
        assert!(line.head.starts_with("fragment Line"), "{}", line.head);
        assert!(line.doc.is_some());
    }
}
