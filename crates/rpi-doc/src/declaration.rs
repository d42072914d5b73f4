//! A declaration in HTML: signature, doc comment, members, net.

use rpi_driver::Inspection;
use rpi_sema::query::{Def, DefId, DefKind};
use rpi_syntax::Dialect;
use rpi_syntax::ast::{Item, ItemKind};

use crate::code;
use crate::drawing;
use crate::html::escape;
use crate::links::LinkMap;
use crate::markdown::to_html;
use crate::members;

/// Context in which the sections of a page are written: the checked module, the targets of links, and the page with the
/// source text of the module.
pub(crate) struct PageContext<'s> {
    pub(crate) inspected: &'s Inspection,
    pub(crate) links: &'s LinkMap,
    /// Path of the page with the source text of the module, relative to the page of the module.
    pub(crate) listing: String,
}

impl PageContext<'_> {
    /// Returns the address to which the name `name` is linked where the declaration `from` uses it. Returns `None` for
    /// the name of the declaration itself, a name without a page and a local name.
    pub(crate) fn link(&self, from: &Def, name: &str) -> Option<String> {
        let (file, offset) = (from.span.file, from.span.end);
        let index = self.inspected.index();
        let found = index.resolve_path(file, offset, name)?;
        let own = index.def(found).span == from.span;
        let top = name.contains('.') || crate::links::is_top(self.inspected, index.def(found));
        (!own && top)
            .then(|| self.links.href(self.inspected, found))
            .flatten()
    }

    /// Returns the section of a page that describes one declaration, in HTML.
    pub(crate) fn section(&self, id: DefId, item: &Item) -> String {
        let def = self.inspected.index().def(id);
        let link = |name: &str| self.link(def, name);
        let (name, kind) = (escape(&def.name), def.kind.description());
        let mut out = format!(
            "<section class=\"declaration\" id=\"{name}\">\n<h3><a href=\"#{name}\">{name}</a> <span class=\"kind\">{kind}</span>"
        );
        out.push_str(&self.source_link(def));
        out.push_str("</h3>\n");
        let signature = code::code(&self.signature(def, item), self.inspected.mode(), &link);
        out.push_str(&format!(
            "<pre class=\"signature\"><code>{signature}</code></pre>\n"
        ));
        if let Some(doc) = &def.doc {
            out.push_str(&format!(
                "<div class=\"doc\">\n{}</div>\n",
                to_html(doc, &link)
            ));
        }
        out.push_str(&members::tables(self.inspected, id, &link));
        out.push_str(&self.drawing(id, item));
        out.push_str("</section>\n");
        out
    }

    /// Returns the link from a declaration to its line in the listing of its source file, in HTML. The link is empty
    /// for a declaration of another file, whose listing is not part of the site.
    fn source_link(&self, def: &Def) -> String {
        if Some(def.span.file) != self.inspected.sources.files().next() {
            return String::new();
        }
        let listing = &self.listing;
        let line = self.inspected.sources.line_col(def.span).line;
        format!(
            " <a class=\"source\" href=\"{listing}#L{line}\" title=\"line {line} of the source\">source</a>"
        )
    }

    /// Returns the formatted text of a declaration without its body. If one item declares several constants or types,
    /// the text contains only the constant or type `def`.
    fn signature(&self, def: &Def, item: &Item) -> String {
        match def.kind {
            DefKind::Const => {
                format!(
                    "const {}: {}",
                    def.name,
                    members::type_text(self.inspected, def)
                )
            }
            DefKind::Type => {
                let whole = self
                    .inspected
                    .sources
                    .slice(def.full_span)
                    .trim_end_matches(';');
                format!("type {whole}")
            }
            _ => without_docs(&rpi_syntax::header(item, self.inspected.mode())),
        }
    }

    fn drawing(&self, id: DefId, item: &Item) -> String {
        let def = self.inspected.index().def(id);
        let Some(drawn) = drawing::draw_declaration(self, id, item) else {
            return String::new();
        };
        let open = if drawn.is_small { " open" } else { "" };
        let (what, title) = match item.kind {
            ItemKind::Task(_) => ("Steps", format!("Steps of {}", def.name)),
            _ => ("Net", format!("Net of {}", def.name)),
        };
        let name = format!("net-{}", def.name);
        let svg = drawn.svg(&name, &title);
        format!(
            "<details class=\"net\"{open}><summary>{what}</summary>\n<div class=\"canvas\" tabindex=\"0\">\n{svg}</div>\n</details>\n"
        )
    }
}

/// Removes the lines with doc comments of members from the text of a declaration. The tables below the signature show
/// these comments.
fn without_docs(head: &str) -> String {
    let lines = head.lines();
    let kept: Vec<&str> = lines
        .filter(|l| !l.trim_start().starts_with("--|"))
        .collect();
    kept.join("\n")
}

/// Returns the word for a source file in this language, shown beside the title of a page: `module` or `Lustre file`.
pub(crate) fn mode_word(mode: Dialect) -> &'static str {
    match mode {
        Dialect::Rpi => "module",
        Dialect::Lustre => "Lustre file",
    }
}
