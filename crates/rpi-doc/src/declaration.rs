//! A declaration in HTML: signature, doc comment, members, net.

use rpi_driver::Inspected;
use rpi_sema::query::{Def, DefId, DefKind};
use rpi_syntax::Mode;
use rpi_syntax::ast::{Item, ItemKind};

use crate::code;
use crate::drawing;
use crate::html::escaped;
use crate::markdown::markdown;
use crate::parts;
use crate::places::Places;

/// Context for the declarations of one file.
pub(crate) struct Shown<'s> {
    pub(crate) seen: &'s Inspected,
    pub(crate) places: &'s Places,
    /// Path of the page with the source text, relative to the page of the module.
    pub(crate) listing: String,
}

impl Shown<'_> {
    /// Returns the target of a name within a declaration. A name of the declaration itself is not linked.
    pub(crate) fn link(&self, from: &Def, name: &str) -> Option<String> {
        let (file, offset) = (from.span.file, from.span.end);
        let index = self.seen.index();
        let found = index.resolve_path(file, offset, name)?;
        let own = index.def(found).span == from.span;
        let top = name.contains('.') || crate::places::is_top(self.seen, index.def(found));
        (!own && top)
            .then(|| self.places.href(self.seen, found))
            .flatten()
    }

    /// Returns the section of a declaration.
    pub(crate) fn section(&self, id: DefId, item: &Item) -> String {
        let def = self.seen.index().def(id);
        let link = |name: &str| self.link(def, name);
        let line = self.seen.sources.line_col(def.span).line;
        let (name, kind) = (escaped(&def.name), def.kind.word());
        let mut out = format!(
            "<section class=\"declaration\" id=\"{name}\">\n<h3><a href=\"#{name}\">{name}</a> <span class=\"kind\">{kind}</span>"
        );
        if Some(def.span.file) == self.seen.sources.files().next() {
            let listing = &self.listing;
            out.push_str(&format!(
                " <a class=\"source\" href=\"{listing}#L{line}\" title=\"line {line} of the source\">source</a>"
            ));
        }
        out.push_str("</h3>\n");
        let signature = code::code(&self.signature(def, item), self.seen.mode(), &link);
        out.push_str(&format!(
            "<pre class=\"signature\"><code>{signature}</code></pre>\n"
        ));
        if let Some(doc) = &def.doc {
            out.push_str(&format!(
                "<div class=\"doc\">\n{}</div>\n",
                markdown(doc, &link)
            ));
        }
        out.push_str(&parts::tables(self.seen, id, &link));
        out.push_str(&self.drawing(id, item));
        out.push_str("</section>\n");
        out
    }

    /// Returns the declaration without its body, formatted. Of several constants or types in one item, returns only
    /// this one.
    fn signature(&self, def: &Def, item: &Item) -> String {
        match def.kind {
            DefKind::Const => {
                format!("const {}: {}", def.name, parts::type_text(self.seen, def))
            }
            DefKind::Type => {
                let whole = self.seen.sources.slice(def.whole).trim_end_matches(';');
                format!("type {whole}")
            }
            _ => without_docs(&rpi_syntax::head(item, self.seen.mode())),
        }
    }

    fn drawing(&self, id: DefId, item: &Item) -> String {
        let def = self.seen.index().def(id);
        let Some(drawn) = drawing::of(self, id, item) else {
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

/// Removes the doc comments of members, which are shown in the tables below the signature.
fn without_docs(head: &str) -> String {
    let lines = head.lines();
    let kept: Vec<&str> = lines
        .filter(|l| !l.trim_start().starts_with("--|"))
        .collect();
    kept.join("\n")
}

/// Returns the description of a file of this language.
pub(crate) fn mode_word(mode: Mode) -> &'static str {
    match mode {
        Mode::Rpi => "module",
        Mode::Lustre => "Lustre file",
    }
}
