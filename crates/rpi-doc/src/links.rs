//! Links to declarations: the page of a declaration, and its anchor there.

use std::collections::BTreeMap;

use rpi_driver::Inspection;
use rpi_sema::query::{Def, DefId, DefKind};

/// Map from the source files that the site shows to the names of their pages, for links to declarations.
#[derive(Default)]
pub(crate) struct LinkMap {
    pages: BTreeMap<String, String>,
}

impl LinkMap {
    /// Records that the page named `page` (without extension) shows the source file `source`.
    pub(crate) fn add(&mut self, source: &str, page: &str) {
        self.pages.insert(source.to_owned(), page.to_owned());
    }

    /// Returns the name of the page of a source file, without extension; `None` for a file that the site does not show.
    pub(crate) fn page(&self, source: &str) -> Option<&str> {
        self.pages.get(source).map(String::as_str)
    }

    /// Returns the address of a definition, relative to the root folder of the site; `None` if the site does not show
    /// its file.
    pub(crate) fn href(&self, seen: &Inspection, id: DefId) -> Option<String> {
        let def = seen.index().def(id);
        let page = self.page(seen.sources.name(def.span.file))?;
        match def.kind {
            DefKind::Module => Some(format!("{page}.html")),
            _ => Some(format!("{page}.html#{}", anchor(seen, id)?)),
        }
    }

    /// Returns the address of a top-level declaration, relative to the root folder of the site; `None` for other
    /// definitions.
    pub(crate) fn href_of_top(&self, seen: &Inspection, id: DefId) -> Option<String> {
        is_top(seen, seen.index().def(id))
            .then(|| self.href(seen, id))
            .flatten()
    }
}

/// Returns whether a definition is a declaration at the top level of a module, such as a node; tests do not count.
pub(crate) fn is_top(seen: &Inspection, def: &Def) -> bool {
    let parent = def.parent.map(|id| seen.index().def(id).kind);
    def.kind != DefKind::Test && matches!(parent, None | Some(DefKind::Module))
}

/// Returns the HTML id at which a page shows a definition, such as `Line` or `Line.pose`. A definition that is not
/// shown has the id of the declaration around it; `None` if there is none.
pub(crate) fn anchor(seen: &Inspection, id: DefId) -> Option<String> {
    let index = seen.index();
    let def = index.def(id);
    if is_top(seen, def) {
        return Some(def.name.to_string());
    }
    let parent = def.parent?;
    match is_top(seen, index.def(parent)) && is_part(def.kind) {
        true => Some(format!("{}.{}", index.def(parent).name, def.name)),
        false => anchor(seen, parent),
    }
}

/// Returns whether definitions of this kind, such as ports and fields, are shown as members of their declaration.
pub(crate) fn is_part(kind: DefKind) -> bool {
    use DefKind::{Field, Input, Output, Param, Port, Result, StaticParam, TakenOver};
    matches!(
        kind,
        StaticParam | Param | Input | TakenOver | Output | Field | Port | Result
    )
}
