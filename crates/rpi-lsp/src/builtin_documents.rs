//! Built-in texts as files that an editor can open: the standard library and the pages of diagnostic codes.
//!
//! Copies are written to the user's cache directory on first use. They are for reading only: the compiler uses the
//! embedded texts.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};

use rpi_diag::Code;

/// Prefix of the names under which the compiler reports source files of the standard library.
const LIBRARY_PREFIX: &str = "stdlib/";

/// Environment variables that give a base directory, each with the directory of the cache below it. The first variable
/// with an absolute path is used.
const CACHE_VARIABLES: &[(&str, &str)] = &[
    ("XDG_CACHE_HOME", "rpi"),
    ("LOCALAPPDATA", "rpi"),
    ("HOME", ".cache/rpi"),
];

/// Directory of the copies of built-in texts for this version of the tool. An editor opens the copies for reading only.
static CACHE_DIR: LazyLock<PathBuf> = LazyLock::new(|| {
    let set = |(name, below): &(&str, &str)| {
        let folder = std::env::var_os(name).map(PathBuf::from);
        folder.filter(|f| f.is_absolute()).map(|f| f.join(below))
    };
    let cache = CACHE_VARIABLES.iter().find_map(set);
    let cache = cache.unwrap_or_else(|| std::env::temp_dir().join("rpi"));
    cache.join(env!("CARGO_PKG_VERSION"))
});

/// Returns the path at which an editor can open a source file. For a file of the standard library, this is the path of
/// a copy in the cache.
pub(crate) fn source_path(name: &str) -> PathBuf {
    library_path(name).unwrap_or_else(|| PathBuf::from(name))
}

/// Returns whether a path, or a name of a source file in diagnostics, is that of a built-in text or of its copy.
pub(crate) fn is_builtin(path: &Path) -> bool {
    let name = path
        .to_str()
        .and_then(|name| name.strip_prefix(LIBRARY_PREFIX));
    let module = name.and_then(|name| name.strip_suffix(".rpi"));
    let is_library = module.is_some_and(|module| rpi_driver::library_text(module).is_some());
    is_library || path.starts_with(&*CACHE_DIR)
}

fn library_path(name: &str) -> Option<PathBuf> {
    let module = name.strip_prefix(LIBRARY_PREFIX)?.strip_suffix(".rpi")?;
    write_once(name, rpi_driver::library_text(module)?)
}

/// Returns the path of a copy of the explanation page of a diagnostic code, with the text that `rpic explain` prints.
/// Returns `None` if the copy cannot be written.
pub(crate) fn code_page_path(code: Code) -> Option<PathBuf> {
    write_once(&format!("findings/{code}.md"), code.page())
}

/// Paths of the copies that this process has written, by the name of the built-in text; [`None`] if the copy could not
/// be written.
static WRITTEN: Mutex<BTreeMap<String, Option<PathBuf>>> = Mutex::new(BTreeMap::new());

fn write_once(name: &str, text: &str) -> Option<PathBuf> {
    let mut laid = WRITTEN.lock().unwrap_or_else(PoisonError::into_inner);
    let path = laid.entry(name.to_owned());
    path.or_insert_with(|| write_copy(name, text)).clone()
}

/// Writes a text to a file of the cache that is marked as read-only, unless the file already has this content. Returns
/// the path of the file; `None` if it cannot be written.
fn write_copy(name: &str, text: &str) -> Option<PathBuf> {
    let path = CACHE_DIR.join(name);
    let is_there = std::fs::read(&path).is_ok_and(|old| old == text.as_bytes());
    if !is_there {
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new(""))).ok()?;
        // An old copy is read-only, and is replaced as a whole.
        let _ = std::fs::remove_file(&path);
        std::fs::write(&path, text).ok()?;
    }
    mark_read_only(&path);
    Some(path)
}

/// Marks a file as read-only, so that editors open it without offering to change it. On a file system without this mark
/// the copy stays writable, and changes to it have no effect.
fn mark_read_only(path: &Path) {
    if let Ok(metadata) = std::fs::metadata(path) {
        let mut permissions = metadata.permissions();
        permissions.set_readonly(true);
        let _ = std::fs::set_permissions(path, permissions);
    }
}
