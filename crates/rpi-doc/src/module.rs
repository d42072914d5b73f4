//! Page of a module, and the parts of it that other pages show.

use rpi_driver::{Inspection, doc_blocks};
use rpi_sema::query::{Def, DefId, DefKind};
use rpi_syntax::ast::{Item, ItemKind};

use crate::declaration::PageContext;
use crate::html::escape;
use crate::links::is_top;
use crate::markdown::{summary, to_html};

/// Sections of a module page in their order: kind of the listed declarations, and title.
const SECTIONS: &[(DefKind, &str)] = &[
    (DefKind::Command, "Commands"),
    (DefKind::Task, "Tasks"),
    (DefKind::Fragment, "Fragments"),
    (DefKind::Node, "Nodes"),
    (DefKind::Function, "Functions"),
    (DefKind::Device, "Device types"),
    (DefKind::Type, "Types"),
    (DefKind::Const, "Constants"),
    (DefKind::Frame, "Frames"),
    (DefKind::Primitive, "Primitives"),
];

/// Returns the sections of a module page: the title of each, and its declarations in source order. Sections without
/// declarations are omitted.
pub(crate) fn sections(seen: &Inspection) -> Vec<(&'static str, Vec<(DefId, &Item)>)> {
    let declared = declared(seen);
    let of = |kind: DefKind| {
        let found = declared.iter();
        let found = found.filter(|(id, _)| seen.index().def(*id).kind == kind);
        found.copied().collect::<Vec<_>>()
    };
    let all = SECTIONS.iter().map(|(kind, title)| (*title, of(*kind)));
    all.filter(|(_, found)| !found.is_empty()).collect()
}

/// Returns every declaration in the files of the module itself, without tests and imported declarations.
fn declared(seen: &Inspection) -> Vec<(DefId, &Item)> {
    let mut found = Vec::new();
    for item in seen.own_items() {
        if matches!(item.kind, ItemKind::Test(_) | ItemKind::Error(_)) {
            continue;
        }
        let inside = |def: &Def| {
            let span = item.span;
            is_top(seen, def) && span.start <= def.span.start && def.span.end <= span.end
        };
        let defs = seen.index().defs_in(item.span.file);
        found.extend(
            defs.filter(|(_, def)| inside(def))
                .map(|(id, _)| (id, item)),
        );
    }
    found
}

/// Returns the description of the module: the doc comment at the top of its main file, if an empty line or a `use`
/// follows it; else `None`.
pub(crate) fn description(seen: &Inspection) -> Option<String> {
    let file = seen.sources.files().next()?;
    let text = seen.sources.text(file);
    let block = doc_blocks(text, seen.mode()).into_iter().next()?;
    let (first, last) = (block.first()?, block.last()?);
    let before = text[..first.start].trim_start_matches("--|").trim();
    let after = &text[last.end..];
    let alone = after.trim_start_matches(['\r', ' ']).starts_with("\n\n") || is_before_use(after);
    let lines = block.iter().map(|line| &text[line.clone()]);
    (before.is_empty() && alone).then(|| lines.collect::<Vec<_>>().join("\n"))
}

fn is_before_use(after: &str) -> bool {
    after.trim_start().starts_with("use ")
}

/// Returns the main content of a module page in HTML: description, overview tables, declarations and tests. `name` is
/// the name of the module.
pub(crate) fn content(shown: &PageContext<'_>, name: &str) -> String {
    let seen = shown.inspected;
    let word = crate::declaration::mode_word(seen.mode());
    let mut out = format!(
        "<h1>{} <span class=\"kind\">{word}</span> <a class=\"source\" href=\"{}\">source</a></h1>\n",
        escape(name),
        shown.listing
    );
    if let Some(about) = description(seen) {
        let link = |name: &str| module_link(shown, name);
        out.push_str(&format!(
            "<div class=\"doc\">\n{}</div>\n",
            to_html(&about, &link)
        ));
    }
    let sections = sections(seen);
    for (title, found) in &sections {
        out.push_str(&overview(seen, title, found));
    }
    for (title, found) in &sections {
        out.push_str(&format!("<h2 id=\"{}\">{title}</h2>\n", id_of(title)));
        out.extend(found.iter().map(|(id, item)| shown.section(*id, item)));
    }
    out.push_str(&tests(shown));
    out
}

fn id_of(title: &str) -> String {
    format!("-{}", title.to_lowercase().replace(' ', "-"))
}

fn module_link(shown: &PageContext<'_>, name: &str) -> Option<String> {
    let file = shown.inspected.sources.files().next()?;
    let found = shown.inspected.index().resolve_path(file, 0, name)?;
    shown.links.href(shown.inspected, found)
}

fn overview(seen: &Inspection, title: &str, found: &[(DefId, &Item)]) -> String {
    let mut out = format!(
        "<table class=\"overview\"><caption><a href=\"#{}\">{title}</a></caption>\n<tbody>\n",
        id_of(title)
    );
    for (id, _) in found {
        let def = seen.index().def(*id);
        let name = escape(&def.name);
        let about = def.doc.as_deref().map(summary).unwrap_or_default();
        out.push_str(&format!(
            "<tr><th scope=\"row\"><a href=\"#{name}\">{name}</a></th><td>{about}</td></tr>\n"
        ));
    }
    out.push_str("</tbody></table>\n");
    out
}

/// Returns the HTML list of the tests that a module declares; empty if there are none.
fn tests(shown: &PageContext<'_>) -> String {
    let tests = shown
        .inspected
        .own_items()
        .filter_map(|item| match &item.kind {
            ItemKind::Test(test) => Some(&test.title),
            _ => None,
        });
    let lines: Vec<String> = tests
        .map(|title| {
            let line = shown.inspected.sources.line_col(title.span).line;
            let title = escape(&title.name);
            format!(
                "<li><a href=\"{}#L{line}\">{title}</a></li>\n",
                shown.listing
            )
        })
        .collect();
    match lines.is_empty() {
        true => String::new(),
        false => format!(
            "<h2 id=\"-tests\">Tests</h2>\n<ul class=\"tests\">\n{}</ul>\n",
            lines.concat()
        ),
    }
}

/// Returns the side bar of a module page in HTML: links to all declarations, by section.
pub(crate) fn side_bar(seen: &Inspection) -> String {
    let mut out = String::new();
    for (title, found) in sections(seen) {
        out.push_str(&format!(
            "<h2><a href=\"#{}\">{title}</a></h2>\n<ul>\n",
            id_of(title)
        ));
        for (id, _) in found {
            let name = escape(&seen.index().def(id).name);
            out.push_str(&format!("<li><a href=\"#{name}\">{name}</a></li>\n"));
        }
        out.push_str("</ul>\n");
    }
    out
}
