//! Built-in texts as files that an editor can open: the standard library, and the pages of findings.
//!
//! They are laid into the user's cache when they are first referred to. Copies, to be read: the compiler uses its own.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};

use rpi_diag::Code;

/// Names of the library's sources in findings begin so.
const LIBRARY: &str = "stdlib/";

/// Environment variables that name a folder for caches, and what is below it for us.
const CACHES: &[(&str, &str)] = &[
    ("XDG_CACHE_HOME", "rpi"),
    ("LOCALAPPDATA", "rpi"),
    ("HOME", ".cache/rpi"),
];

static SHELF: LazyLock<PathBuf> = LazyLock::new(|| {
    let set = |(name, below): &(&str, &str)| {
        let folder = std::env::var_os(name).map(PathBuf::from);
        folder.filter(|f| f.is_absolute()).map(|f| f.join(below))
    };
    let cache = CACHES.iter().find_map(set);
    let cache = cache.unwrap_or_else(|| std::env::temp_dir().join("rpi"));
    cache.join(env!("CARGO_PKG_VERSION"))
});

/// The file behind a source's name: of the standard library the copy on the shelf.
pub(crate) fn file_of(name: &str) -> PathBuf {
    library(name).unwrap_or_else(|| PathBuf::from(name))
}

fn library(name: &str) -> Option<PathBuf> {
    let module = name.strip_prefix(LIBRARY)?.strip_suffix(".rpi")?;
    lay(name, rpi_driver::library_text(module)?)
}

/// The page of a finding: what `rpic explain` prints.
pub(crate) fn page_of(code: Code) -> Option<PathBuf> {
    lay(&format!("findings/{code}.md"), code.page())
}

/// What was laid onto the shelf by this process, and where; none where that failed.
static LAID: Mutex<BTreeMap<String, Option<PathBuf>>> = Mutex::new(BTreeMap::new());

fn lay(name: &str, text: &str) -> Option<PathBuf> {
    let mut laid = LAID.lock().unwrap_or_else(PoisonError::into_inner);
    let path = laid.entry(name.to_owned());
    path.or_insert_with(|| written(name, text)).clone()
}

/// Writes a text if it is not there as it is.
fn written(name: &str, text: &str) -> Option<PathBuf> {
    let path = SHELF.join(name);
    let is_there = std::fs::read(&path).is_ok_and(|old| old == text.as_bytes());
    if !is_there {
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new(""))).ok()?;
        std::fs::write(&path, text).ok()?;
    }
    Some(path)
}
