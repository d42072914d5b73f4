//! Generated pages: a small project compared exactly, every page of the standard library, and properties of all pages.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use html5ever::tendril::TendrilSink;
use html5ever::{ParseOpts, parse_document};
use markup5ever_rcdom::{Handle, NodeData, RcDom};
use rpi_doc::{Module, Site};
use rpi_driver::{DiskLoader, FileLoader, inspect, library_modules, library_text};
use rpi_testkit::workspace_root;

struct Nothing;

impl FileLoader for Nothing {
    fn text(&self, _: &Path) -> Option<String> {
        None
    }
}

fn library() -> Vec<Module> {
    let module = |name: &str| Module {
        name: name.to_owned(),
        is_library: true,
        inspected: inspect(
            &PathBuf::from(format!("stdlib/{name}.rpi")),
            library_text(name).unwrap(),
            &Nothing,
        ),
    };
    library_modules().map(module).collect()
}

/// Returns the site of the program beside this test and the library.
fn belt() -> Site {
    let text = include_str!("data/belt.rpi");
    let mut modules = vec![Module {
        name: "belt".to_owned(),
        is_library: false,
        inspected: inspect(Path::new("belt.rpi"), text, &DiskLoader),
    }];
    assert_eq!(modules[0].inspected.diagnostics, []);
    modules.extend(library());
    Site::new("belt & more", "A *cell* with `a < b`.", &modules)
}

fn page<'s>(site: &'s Site, name: &str) -> &'s str {
    let found = site.files.iter().find(|(file, _)| file == name);
    &found.unwrap_or_else(|| panic!("no {name}")).1
}

/// Rule M12.2.
#[test]
fn a_page_is_what_it_was() {
    let path = workspace_root().join("crates/rpi-doc/tests/data/belt.html");
    let site = belt();
    let page = page(&site, "belt.html");
    if std::env::var_os("RPI_BLESS").is_some() {
        std::fs::write(&path, page).unwrap();
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_default();
    let first = page
        .lines()
        .zip(expected.lines())
        .find(|(is, should)| is != should);
    assert!(
        page == expected,
        "`cargo xtask bless doc` updates the file; first difference: {first:#?}"
    );
}

#[test]
fn the_same_program_gives_the_same_pages() {
    assert_eq!(belt(), belt());
}

#[test]
fn every_module_of_the_library_has_a_page_with_all_its_names() {
    let modules = library();
    let site = Site::new("library", "", &modules);
    for module in &modules {
        let page = page(&site, &format!("{}.html", module.name));
        let ids = ids(page);
        for name in declared(library_text(&module.name).unwrap()) {
            assert!(
                ids.contains(&name),
                "{} is not on the page of {}",
                name,
                module.name
            );
        }
    }
}

/// Returns the names that follow declaring keywords.
fn declared(text: &str) -> Vec<String> {
    let words = [
        "node", "function", "fragment", "device", "command", "task", "const",
    ];
    let of_line = |line: &str| {
        let (word, rest) = line.split_once(' ')?;
        let name: String = rest
            .chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect();
        words.contains(&word).then_some(name)
    };
    text.lines().filter_map(of_line).collect()
}

#[test]
fn all_pages_are_right_html() {
    for (name, text) in belt()
        .files
        .iter()
        .filter(|(name, _)| name.ends_with(".html"))
    {
        let errors = parsed(text).errors;
        assert!(errors.borrow().is_empty(), "{name}: {:?}", errors.borrow());
    }
}

#[test]
fn ids_are_there_once() {
    for (name, text) in belt()
        .files
        .iter()
        .filter(|(name, _)| name.ends_with(".html"))
    {
        let mut seen = BTreeSet::new();
        for (_, value) in attributes(text).into_iter().filter(|(key, _)| key == "id") {
            assert!(seen.insert(value.clone()), "{name}: {value} twice");
        }
    }
}

#[test]
fn links_lead_to_places_that_exist() {
    let site = belt();
    let ids: BTreeMap<&str, BTreeSet<String>> = site
        .files
        .iter()
        .map(|(name, text)| {
            (
                name.as_str(),
                if name.ends_with(".html") {
                    ids(text)
                } else {
                    BTreeSet::new()
                },
            )
        })
        .collect();
    let mut count = 0;
    for (name, text) in site
        .files
        .iter()
        .filter(|(name, _)| name.ends_with(".html"))
    {
        for (key, value) in attributes(text) {
            if !["href", "src"].contains(&key.as_str()) || value.starts_with("https:") {
                continue;
            }
            count += 1;
            let (file, place) = value.split_once('#').unwrap_or((&value, ""));
            let target = resolved(name, file);
            let found = ids.get(target.as_str());
            assert!(found.is_some(), "{name}: {value} leads to no page");
            let there = place.is_empty() || found.is_some_and(|ids| ids.contains(place));
            assert!(there, "{name}: {value} leads to no place");
        }
    }
    assert!(count > 1000, "only {count} links");
}

#[test]
fn names_for_the_search_are_there_and_lead_somewhere() {
    let site = belt();
    let names = page(&site, "names.js");
    assert!(
        names.contains(
            "[\"Grip\", \"command\", \"belt\", \"belt.html#Grip\", \"Closes the gates.\"]"
        ),
        "{names}"
    );
    assert!(ids(page(&site, "belt.html")).contains("Grip"));
}

#[test]
fn nothing_comes_from_elsewhere() {
    for (name, text) in &belt().files {
        let fetched = [
            "<img",
            "@import",
            "url(http",
            "src=\"http",
            "<iframe",
            "fetch(",
        ];
        let bad: Vec<_> = fetched
            .iter()
            .filter(|word| text.contains(**word))
            .collect();
        assert!(bad.is_empty(), "{name}: {bad:?}");
    }
}

#[test]
fn markup_in_doc_comments_is_text() {
    let site = belt();
    assert!(page(&site, "belt.html").contains("&lt;b&gt;everything&lt;/b&gt;"));
}

/// Returns the file to which a link on a page leads.
fn resolved(page: &str, file: &str) -> String {
    let folder = page.rsplit_once('/').map_or("", |(folder, _)| folder);
    match (file, file.strip_prefix("../")) {
        ("", _) => page.to_owned(),
        (_, Some(up)) => up.to_owned(),
        (file, None) if folder.is_empty() => file.to_owned(),
        (file, None) => format!("{folder}/{file}"),
    }
}

fn parsed(text: &str) -> RcDom {
    parse_document(RcDom::default(), ParseOpts::default()).one(text)
}

fn ids(text: &str) -> BTreeSet<String> {
    let all = attributes(text).into_iter();
    all.filter(|(key, _)| key == "id")
        .map(|(_, value)| value)
        .collect()
}

/// Returns every attribute of a page.
fn attributes(text: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    // Dropping a node drops its children, so the tree must live until the end.
    let tree = parsed(text);
    let mut open: Vec<Handle> = vec![tree.document.clone()];
    while let Some(node) = open.pop() {
        if let NodeData::Element { attrs, .. } = &node.data {
            let attrs = attrs.borrow();
            found.extend(
                attrs
                    .iter()
                    .map(|a| (a.name.local.to_string(), a.value.to_string())),
            );
        }
        open.extend(node.children.borrow().iter().cloned());
    }
    found
}
