//! On which page a declaration stands, and where on it.

use std::collections::BTreeMap;

use rpi_driver::Inspected;
use rpi_sema::query::{Def, DefId, DefKind};

/// The pages by the source files that they show.
#[derive(Default)]
pub(crate) struct Places {
    pages: BTreeMap<String, String>,
}

impl Places {
    /// Notes that a source file is shown on a page.
    pub(crate) fn add(&mut self, source: &str, page: &str) {
        self.pages.insert(source.to_owned(), page.to_owned());
    }

    /// The page of a source file, without ending.
    pub(crate) fn page(&self, source: &str) -> Option<&str> {
        self.pages.get(source).map(String::as_str)
    }

    /// Where a definition is shown: a link for a page in the folder of the pages.
    pub(crate) fn href(&self, seen: &Inspected, id: DefId) -> Option<String> {
        let def = seen.index().def(id);
        let page = self.page(seen.sources.name(def.span.file))?;
        match def.kind {
            DefKind::Module => Some(format!("{page}.html")),
            _ => Some(format!("{page}.html#{}", anchor(seen, id)?)),
        }
    }

    /// Where a declaration of its own is shown; none for what stands inside of one.
    pub(crate) fn href_of_top(&self, seen: &Inspected, id: DefId) -> Option<String> {
        is_top(seen, seen.index().def(id))
            .then(|| self.href(seen, id))
            .flatten()
    }
}

/// Whether a definition stands in a module, not inside another one.
pub(crate) fn is_top(seen: &Inspected, def: &Def) -> bool {
    let parent = def.parent.map(|id| seen.index().def(id).kind);
    def.kind != DefKind::Test && matches!(parent, None | Some(DefKind::Module))
}

/// The id of a definition on its page: `Line`, `Line.pose`. None for what pages do not show by itself.
pub(crate) fn anchor(seen: &Inspected, id: DefId) -> Option<String> {
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

/// Whether pages show such a definition within the declaration in which it stands.
pub(crate) fn is_part(kind: DefKind) -> bool {
    use DefKind::{Field, Given, Input, Output, Param, Port, Result, Static};
    matches!(
        kind,
        Static | Param | Input | Given | Output | Field | Port | Result
    )
}
