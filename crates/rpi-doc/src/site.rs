//! Files of the site: pages of modules, source texts, index, style sheet and search script.

use std::collections::BTreeSet;

use rpi_driver::Inspection;

use crate::code;
use crate::declaration::PageContext;
use crate::html::{Page, escape};
use crate::links::{LinkMap, is_top};
use crate::markdown::{plain_text, summary, to_html};
use crate::module;

const STYLE: &str = include_str!("../assets/style.css");
const SEARCH: &str = include_str!("../assets/search.js");
const SEARCH_BOX: &str = include_str!("../assets/search-box.js");

/// Checked module for which the site gets a page.
#[derive(Debug)]
pub struct Module {
    /// Name of the module, as a `use` of the module writes it.
    pub name: String,
    /// True if the module belongs to the standard library; its page is listed apart.
    pub is_library: bool,
    /// Result of checking the module. Its first file is the main file of the module.
    pub inspected: Inspection,
}

/// Generated reference: all files of the HTML pages.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Site {
    /// Name and content of each file, sorted by name. Names are relative to the root folder of the site, with `/`
    /// between folders.
    pub files: Vec<(String, String)>,
}

impl Site {
    /// Generates the reference of `modules`. `title` is the name of the project, `about` the Markdown text on the start
    /// page.
    #[must_use]
    pub fn new(title: &str, about: &str, modules: &[Module]) -> Site {
        let shelf = SiteBuilder::new(title, modules);
        let mut files = vec![
            ("index.html".to_owned(), shelf.index(about)),
            ("names.js".to_owned(), shelf.names()),
            ("search.js".to_owned(), SEARCH.to_owned()),
            ("search-box.js".to_owned(), SEARCH_BOX.to_owned()),
            ("style.css".to_owned(), STYLE.to_owned()),
        ];
        for (module, page) in modules.iter().zip(&shelf.pages) {
            files.push((format!("{page}.html"), shelf.module(module, page)));
            files.push((format!("src/{page}.html"), shelf.source(module, page)));
        }
        files.sort();
        Site { files }
    }
}

/// Generator of the pages of a site: the modules, the file names of their pages, and the targets of links.
struct SiteBuilder<'m> {
    title: &'m str,
    modules: &'m [Module],
    /// File name of the page of each module without extension, in the order of the modules.
    pages: Vec<String>,
    links: LinkMap,
}

impl<'m> SiteBuilder<'m> {
    fn new(title: &'m str, modules: &'m [Module]) -> SiteBuilder<'m> {
        let mut taken: BTreeSet<String> = BTreeSet::from(["index".to_owned()]);
        let mut places = LinkMap::default();
        let mut pages = Vec::new();
        for module in modules {
            let page = unique(&page_name(&module.name), &mut taken);
            let mut own: Vec<_> = module
                .inspected
                .own_items()
                .map(|item| item.span.file)
                .collect();
            own.extend(module.inspected.sources.files().next());
            own.sort();
            own.dedup();
            let names = own
                .into_iter()
                .map(|file| module.inspected.sources.name(file));
            names.for_each(|name| places.add(name, &page));
            pages.push(page);
        }
        SiteBuilder {
            title,
            modules,
            pages,
            links: places,
        }
    }

    fn page(&self, title: &str, up: &'static str, side: &str, main: &str) -> String {
        let side = format!("{}{side}", self.contents(up));
        Page {
            title,
            project: self.title,
            up,
            side: &side,
            main,
        }
        .html()
    }

    /// Returns the list of modules for the side bar of every page, in HTML. `up` is the relative path from the page to
    /// the root folder of the site.
    fn contents(&self, up: &str) -> String {
        let line = |(module, page): (&Module, &String)| {
            let name = escape(&module.name);
            format!("<li><a href=\"{up}{page}.html\">{name}</a></li>\n")
        };
        let all = self.modules.iter().zip(&self.pages).map(line);
        format!(
            "<h2><a href=\"{up}index.html\">Modules</a></h2>\n<ul>\n{}</ul>\n",
            all.collect::<String>()
        )
    }

    fn module(&self, module: &Module, page: &str) -> String {
        let shown = PageContext {
            inspected: &module.inspected,
            links: &self.links,
            listing: format!("src/{page}.html"),
        };
        let main = module::content(&shown, &module.name);
        self.page(
            &module.name,
            "",
            &module::side_bar(&module.inspected),
            &main,
        )
    }

    /// Returns the page with the source text of the main file of a module.
    fn source(&self, module: &Module, page: &str) -> String {
        let name = escape(&module.name);
        let mut main = format!(
            "<h1><a href=\"../{page}.html\">{name}</a> <span class=\"kind\">source</span></h1>\n"
        );
        if let Some(file) = module.inspected.sources.files().next() {
            main.push_str(&code::listing(
                module.inspected.sources.text(file),
                module.inspected.mode(),
            ));
        }
        self.page(&format!("{} (source)", module.name), "../", "", &main)
    }

    fn index(&self, about: &str) -> String {
        let mut main = format!("<h1>{}</h1>\n", escape(self.title));
        if !about.is_empty() {
            main.push_str(&format!(
                "<div class=\"doc\">\n{}</div>\n",
                to_html(about, &|_| None)
            ));
        }
        let own = self.module_table("Modules", false);
        let used = if own.is_empty() {
            "Modules"
        } else {
            "Standard library modules"
        };
        main.push_str(&own);
        main.push_str(&self.module_table(used, true));
        main.push_str(&self.all_names());
        self.page(self.title, "", "", &main)
    }

    fn module_table(&self, title: &str, library: bool) -> String {
        let all = self.modules.iter().zip(&self.pages);
        let rows: String = all
            .filter(|(module, _)| module.is_library == library)
            .map(|(module, page)| {
                let about = module::description(&module.inspected);
                let about = about.as_deref().map(summary).unwrap_or_default();
                let name = escape(&module.name);
                format!("<tr><th scope=\"row\"><a href=\"{page}.html\">{name}</a></th><td>{about}</td></tr>\n")
            })
            .collect();
        match rows.is_empty() {
            true => String::new(),
            false => format!(
                "<table class=\"overview\"><caption>{title}</caption>\n<tbody>\n{rows}</tbody></table>\n"
            ),
        }
    }

    /// Returns the list of all declarations of all modules in HTML, sorted by name ignoring case.
    fn all_names(&self) -> String {
        let mut names = self.declarations();
        names.sort_by_key(|name| (name.name.to_lowercase(), name.href.clone()));
        let lines = names.iter().map(|name| {
            let (text, href) = (escape(&name.name), escape(&name.href));
            format!(
                "<li><a href=\"{href}\">{text}</a> <span class=\"kind\">{}</span></li>\n",
                name.kind
            )
        });
        format!(
            "<h2 id=\"-names\">All names</h2>\n<ul class=\"names\">\n{}</ul>\n",
            lines.collect::<String>()
        )
    }

    /// Returns the search index as JavaScript: an array `[name, kind, module, link, summary, details]` for each
    /// declaration. The details are missing if the description has only one sentence.
    fn names(&self) -> String {
        let rows = self.declarations().into_iter().map(|name| {
            let mut cells = vec![
                name.name,
                name.kind.to_owned(),
                name.module,
                name.href,
                name.summary,
            ];
            cells.extend(Some(name.details).filter(|details| !details.is_empty()));
            let cells: Vec<String> = cells.iter().map(|cell| js_string(cell)).collect();
            format!("  [{}]", cells.join(", "))
        });
        let rows: Vec<String> = rows.collect();
        format!("const NAMES = [\n{}\n];\n", rows.join(",\n"))
    }

    fn declarations(&self) -> Vec<IndexEntry> {
        let mut found = Vec::new();
        for module in self.modules {
            let seen = &module.inspected;
            for (id, _) in module::sections(seen)
                .into_iter()
                .flat_map(|(_, found)| found)
            {
                let def = seen.index().def(id);
                let (summary, details) = plain_text(def.doc.as_deref().unwrap_or_default());
                found.extend(
                    self.links
                        .href(seen, id)
                        .filter(|_| is_top(seen, def))
                        .map(|href| IndexEntry {
                            name: def.name.to_string(),
                            kind: def.kind.description(),
                            module: module.name.clone(),
                            href,
                            summary: summary.clone(),
                            details: details.clone(),
                        }),
                );
            }
        }
        found
    }
}

/// Entry of the search index: one declaration.
struct IndexEntry {
    name: String,
    kind: &'static str,
    module: String,
    href: String,
    /// First sentence of the doc comment, without markup.
    summary: String,
    /// Other sentences of the doc comment, without markup and code blocks; empty if there are none.
    details: String,
}

/// Returns the file name of the page of a module, without extension. Characters that are not valid in file names on all
/// systems are replaced by `-`.
fn page_name(module: &str) -> String {
    let kept = |c: char| {
        if c.is_alphanumeric() || "-_.".contains(c) {
            c
        } else {
            '-'
        }
    };
    module.chars().map(kept).collect()
}

fn unique(name: &str, taken: &mut BTreeSet<String>) -> String {
    // On case-insensitive file systems, two page names must not differ in case only.
    let mut candidates = (1..).map(|n| match n {
        1 => name.to_owned(),
        n => format!("{name}-{n}"),
    });
    let free = candidates.find(|candidate| taken.insert(candidate.to_lowercase()));
    free.unwrap_or_default()
}

/// Returns a text as a JavaScript string literal, safe within a script in HTML.
fn js_string(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            // `</script>` must not occur in a script, and U+2028 and U+2029 end a line in JavaScript before ES2019.
            '<' | '\u{2028}' | '\u{2029}' => out.push_str(&format!("\\u{:04x}", u32::from(c))),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_in_scripts_stay_texts() {
        assert_eq!(js_string("a\"</script>\\"), "\"a\\\"\\u003c/script>\\\\\"");
    }

    #[test]
    fn pages_have_names_of_their_own() {
        let mut taken = BTreeSet::from(["index".to_owned()]);
        assert_eq!(unique("Index", &mut taken), "Index-2");
        assert_eq!(page_name("arms/left one"), "arms-left-one");
    }
}
