//! `cargo xtask book`: builds the book with mdBook and checks the links of the built pages.
//!
//! The test `links.rs` of the repository checks the sources of the book. Only the pages show whether an anchor exists,
//! because mdBook derives anchors from headings, and whether the target of a link is part of the book.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};
use std::process::Command;

use crate::fuzz::root;
use crate::task_error::TaskError;

/// Required version of mdBook, which builds the book.
const VERSION: &str = "0.5.4";

/// Minimum number of links in the book. A check that finds fewer links does not read the pages correctly.
const LEAST_LINKS: usize = 1000;

/// Carries out `cargo xtask book`: builds the book in `target/book` and checks the links of its pages. Installs mdBook
/// below `target` if necessary; without mdBook, prints a message and does nothing.
pub(crate) fn book(args: &[String]) -> Result<(), TaskError> {
    if !args.is_empty() {
        return Err("usage: cargo xtask book".into());
    }
    let Some(mdbook) = mdbook() else {
        eprintln!(
            "SKIPPED: the book is not built and its links are not checked: no mdBook {VERSION}"
        );
        return Ok(());
    };
    let pages = target().join("book");
    build(&mdbook, &pages)?;
    let count = check_links(&pages)?;
    println!("{}: {count} links lead to a place", pages.display());
    Ok(())
}

/// Returns the path of mdBook in the required version: the installed program, or one that is built from source now.
/// Returns `None` if the build fails.
///
/// The build takes one or two minutes. It is not optimised, because mdBook runs only for a short time.
fn mdbook() -> Option<PathBuf> {
    let tools = target().join("tools");
    let own = tools.join("bin/mdbook");
    let installed = [PathBuf::from("mdbook"), own.clone()];
    if let Some(found) = installed.into_iter().find(|path| is_right_version(path)) {
        return Some(found);
    }
    eprintln!("installing mdBook {VERSION} below {}", tools.display());
    let status = Command::new(env!("CARGO"))
        .args(["install", "mdbook", "--version", VERSION, "--locked"])
        .args(["--no-default-features", "--debug", "--quiet", "--root"])
        .arg(&tools)
        .env("CARGO_PROFILE_DEV_DEBUG", "0")
        .status();
    let is_built = status.is_ok_and(|status| status.success());
    is_built.then_some(own)
}

fn is_right_version(mdbook: &Path) -> bool {
    let output = Command::new(mdbook).arg("--version").output();
    output.is_ok_and(|output| {
        String::from_utf8_lossy(&output.stdout).trim() == format!("mdbook v{VERSION}")
    })
}

/// Builds the pages of the book in the folder `pages`. A warning of mdBook is an error.
fn build(mdbook: &Path, pages: &Path) -> Result<(), TaskError> {
    let output = Command::new(mdbook)
        .arg("build")
        .arg(root().join("docs"))
        .arg("--dest-dir")
        .arg(pages)
        .output()
        .map_err(|error| format!("{}: {error}", mdbook.display()))?;
    let log = String::from_utf8_lossy(&output.stderr);
    match output.status.success() && !log.contains("WARN") && !log.contains("ERROR") {
        true => Ok(()),
        false => Err(format!("mdBook: {log}").into()),
    }
}

/// Checks that each link of each page in `folder` leads to an existing file and anchor. Returns the number of checked
/// links.
fn check_links(folder: &Path) -> Result<usize, TaskError> {
    let pages = read_pages(folder, folder)?;
    let (mut count, mut broken) = (0, Vec::new());
    for (path, page) in &pages {
        for link in page.links.iter().filter(|link| !is_external(link)) {
            count += 1;
            if let Some(problem) = problem(&pages, path, link) {
                broken.push(format!("{}: {link}: {problem}", path.display()));
            }
        }
    }
    if count < LEAST_LINKS {
        broken.push(format!("only {count} links found"));
    }
    match broken.is_empty() {
        true => Ok(count),
        false => Err(broken.join("\n").into()),
    }
}

/// Returns true if a link leads out of the book: web and mail addresses have a scheme such as `https` before the first
/// colon.
fn is_external(link: &str) -> bool {
    let scheme = link.split_once(':').map_or("", |(scheme, _)| scheme);
    !scheme.is_empty() && scheme.chars().all(|c| c.is_ascii_alphabetic())
}

/// Returns the reason why a link on the page `path` is wrong; `None` if it is correct.
fn problem(pages: &BTreeMap<PathBuf, Page>, path: &Path, link: &str) -> Option<&'static str> {
    let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
    let target = match file {
        "" => path.to_owned(),
        _ => resolved(path.parent().unwrap_or(Path::new("")), file),
    };
    let Some(page) = pages.get(&target) else {
        return Some("no such file in the book");
    };
    let exists = anchor.is_empty() || page.anchors.contains(anchor);
    (!exists).then_some("no such anchor on the page")
}

/// Returns the path of the file to which a link on a page in `folder` leads, relative to the root of the book.
fn resolved(folder: &Path, file: &str) -> PathBuf {
    let mut path = PathBuf::new();
    for part in folder.join(file).components() {
        // A link out of the book keeps its `..` and is found nowhere.
        match (part, path.file_name()) {
            (Component::ParentDir, Some(_)) => drop(path.pop()),
            (Component::CurDir, _) => {}
            _ => path.push(part),
        }
    }
    path
}

/// Links and anchors of a page of the book. Other files have none.
#[derive(Default)]
struct Page {
    links: Vec<String>,
    anchors: BTreeSet<String>,
}

impl Page {
    fn new(html: &str) -> Page {
        let mut page = Page::default();
        for tag in html.split('<').skip(1) {
            let tag = tag.split('>').next().unwrap_or_default();
            page.links.extend(attribute(tag, "href"));
            page.links.extend(attribute(tag, "src"));
            page.anchors.extend(attribute(tag, "id"));
        }
        page
    }
}

/// Returns the value of an attribute in the text of an HTML tag, with the character references of mdBook decoded;
/// `None` if the tag has no such attribute.
fn attribute(tag: &str, name: &str) -> Option<String> {
    let (_, value) = tag.split_once(&format!(" {name}=\""))?;
    let value = value.split('"').next()?;
    let value = value.replace("&#x27;", "'").replace("&quot;", "\"");
    Some(
        value
            .replace("&lt;", "<")
            .replace("&gt;", ">")
            .replace("&amp;", "&"),
    )
}

/// Reads all files below `folder`. Returns their links and anchors by path relative to `top`.
fn read_pages(top: &Path, folder: &Path) -> Result<BTreeMap<PathBuf, Page>, TaskError> {
    let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
    let mut pages = BTreeMap::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.is_dir() {
            pages.extend(read_pages(top, &path)?);
            continue;
        }
        let page = match path
            .extension()
            .is_some_and(|extension| extension == "html")
        {
            true => Page::new(&std::fs::read_to_string(&path).map_err(failed)?),
            false => Page::default(),
        };
        let relative = path.strip_prefix(top).unwrap_or(&path);
        pages.insert(relative.to_owned(), page);
    }
    Ok(pages)
}

/// Returns the folder to which Cargo writes build output.
fn target() -> PathBuf {
    let set = std::env::var_os("CARGO_TARGET_DIR");
    set.map_or_else(|| root().join("target"), PathBuf::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_need_a_file_and_an_anchor() {
        let page = |html: &str| Page::new(html);
        let pages = BTreeMap::from([
            ("a.html".into(), page("<h2 id=\"x&amp;y\">x</h2>")),
            (
                "tutorial/b.html".into(),
                page("<a href=\"../a.html#x\">a</a>"),
            ),
        ]);
        let at = Path::new("tutorial/b.html");
        assert_eq!(pages[at].links, ["../a.html#x"]);
        assert_eq!(problem(&pages, at, "../a.html#x&y"), None);
        assert!(problem(&pages, at, "../a.html#x").is_some());
        assert!(problem(&pages, at, "a.html").is_some());
        assert!(problem(&pages, at, "../../a.html").is_some());
        assert!(is_external("https://example.org") && !is_external("a.html#b:c"));
    }
}
