//! Links to declarations: the page of a declaration, and its anchor there.

use std::collections::BTreeMap;

use rpi_driver::Inspection;
use rpi_sema::query::{Def, DefId, DefKind};

/// Pages by the source files that they show.
#[derive(Default)]
pub(crate) struct LinkMap {
    pages: BTreeMap<String, String>,
}

impl LinkMap {
    /// Records that a source file is shown on a page.
    pub(crate) fn add(&mut self, source: &str, page: &str) {
        self.pages.insert(source.to_owned(), page.to_owned());
    }

    /// Returns the page of a source file, without extension.
    pub(crate) fn page(&self, source: &str) -> Option<&str> {
        self.pages.get(source).map(String::as_str)
    }

    /// Returns a link to a definition, for a page in the root folder of the site.
    pub(crate) fn href(&self, seen: &Inspection, id: DefId) -> Option<String> {
        let def = seen.index().def(id);
        let page = self.page(seen.sources.name(def.span.file))?;
        match def.kind {
            DefKind::Module => Some(format!("{page}.html")),
            _ => Some(format!("{page}.html#{}", anchor(seen, id)?)),
        }
    }

    /// Returns a link to a top-level declaration; `None` for other definitions.
    pub(crate) fn href_of_top(&self, seen: &Inspection, id: DefId) -> Option<String> {
        is_top(seen, seen.index().def(id))
            .then(|| self.href(seen, id))
            .flatten()
    }
}

/// Returns whether a definition is top-level in a module.
pub(crate) fn is_top(seen: &Inspection, def: &Def) -> bool {
    let parent = def.parent.map(|id| seen.index().def(id).kind);
    def.kind != DefKind::Test && matches!(parent, None | Some(DefKind::Module))
}

/// Returns the HTML id of a definition: `Line`, `Line.pose`. A definition that is not shown gets the id of its parent.
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

/// Returns whether definitions of this kind are shown within their declaration.
pub(crate) fn is_part(kind: DefKind) -> bool {
    use DefKind::{Field, Input, Output, Param, Port, Result, StaticParam, TakenOver};
    matches!(
        kind,
        StaticParam | Param | Input | TakenOver | Output | Field | Port | Result
    )
}
